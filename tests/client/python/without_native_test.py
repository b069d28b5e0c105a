"""The package as CMake builds it, without the module that samples in process: a client of servers, which says what it lacks."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import curvecast


class WithoutNativeTest(unittest.TestCase):
    def test_is_a_client_and_says_what_surfaces_take(self) -> None:
        package = pathlib.Path(curvecast.__file__).parent
        program = "import curvecast; print(curvecast.HAS_LOCAL); curvecast.connect; curvecast.Surface([[0, 0, 0]], [[0, 0, 0]])"
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(package, pathlib.Path(folder) / "curvecast", ignore=shutil.ignore_patterns("_native*.so"))
            environment = os.environ | {"PYTHONPATH": os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])}
            run = subprocess.run(
                [sys.executable, "-B", "-c", program], check=False, env=environment, capture_output=True, text=True
            )
        self.assertEqual(run.stdout, "False\n", run.stderr)
        self.assertIn("surfaces in this process take the wheel of deploy/wheel", run.stderr)


if __name__ == "__main__":
    unittest.main()
