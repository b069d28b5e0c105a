"""The examples, as a newcomer runs them."""

import os
import pathlib
import subprocess
import sys
import unittest
from typing import ClassVar

import numpy as np

from fixture import ServerTest, sphere_obj

PACKAGE = pathlib.Path(os.environ["CURVECAST_SOURCE"]) / "client" / "python"


class ExamplesTest(ServerTest):
    mesh: ClassVar[pathlib.Path]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.mesh = cls.folder / "ball.obj"
        cls.mesh.write_text(sphere_obj())

    def run_example(self, name: str, *arguments: object) -> str:
        command = [
            sys.executable,
            "-B",
            str(PACKAGE / "examples" / name),
            self.server.address,
            str(self.mesh),
            *map(str, arguments),
        ]
        finished = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        return finished.stdout

    def test_the_readme(self) -> None:
        of_servers = (PACKAGE / "README.md").read_text().split("\n## With a server\n")[1]
        program = of_servers.split("```python\n")[1].split("```")[0]
        for newcomer, here in (("127.0.0.1:50051", self.server.address), ("armadillo.off", str(self.mesh))):
            self.assertEqual(program.count(newcomer), 1)
            program = program.replace(newcomer, here)
        finished = subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True, check=False)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        self.assertIn("(50000, 3) float32", finished.stdout)
        sequence, points, *_ = finished.stdout.splitlines()[-1].split()
        self.assertEqual(sequence, "41")
        self.assertGreater(int(points), 0)

    def test_sample_to_ply(self) -> None:
        out = self.folder / "points.ply"
        self.assertIn("1000 points", self.run_example("sample_to_ply.py", 1000, out))
        header, data = out.read_bytes().split(b"end_header\n", 1)
        self.assertIn(b"element vertex 1000", header)
        rows = np.frombuffer(data, "<f4").reshape(1000, 7)
        np.testing.assert_allclose(np.linalg.norm(rows[:, :3], axis=1), 1, atol=0.02)
        # The command reads what the example wrote.
        command = [os.environ["CURVECAST_COMMAND"], "measure", str(self.mesh), str(out), "--quiet"]
        environment = os.environ | {"XDG_CACHE_HOME": str(self.folder / "cache")}
        self.assertEqual(subprocess.run(command, env=environment, capture_output=True, check=False).returncode, 0)

    def test_orbit_stream(self) -> None:
        lines = self.run_example("orbit_stream.py", 20, 500).splitlines()
        self.assertEqual(len(lines), 21)
        self.assertIn("key", lines[1])
        self.assertIn("delta", lines[-1])

    def test_training_set(self) -> None:
        out = self.folder / "sets.npz"
        self.run_example("training_set.py", 20, 256, out)
        with np.load(out) as sets:
            self.assertEqual(sets["positions"].shape, (20, 256, 3))
            self.assertEqual(sets["curvatures"].shape, (20, 256, 2))
            self.assertEqual(len(np.unique(sets["positions"].reshape(20, -1), axis=0)), 20)


if __name__ == "__main__":
    unittest.main()
