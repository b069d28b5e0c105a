"""The store in S3, on a real MinIO and through toxiproxy: what s3_live_test has to find. deploy/check_store runs it."""

from __future__ import annotations

import contextlib
import json
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.request
from typing import ClassVar

from free_port import free_port

SOURCE = pathlib.Path(os.environ.get("CURVECAST_SOURCE", pathlib.Path(__file__).parents[2]))
TOOLS = SOURCE / "build/tools"
SECONDS = 60


class StoreTest(unittest.TestCase):
    folder: ClassVar[pathlib.Path]
    #: Of MinIO and of our store.
    secret: ClassVar[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-store-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.secret = secrets.token_urlsafe(24)

    def minio(self, *options: str, scheme: str = "http") -> int:
        """Starts one with a folder of its own; returns its port."""
        port, console = free_port(), free_port()
        data = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        command: list[str | pathlib.Path] = [TOOLS / "minio", "server", data, "--quiet", *options]
        command += ["--address", f"127.0.0.1:{port}", "--console-address", f"127.0.0.1:{console}"]
        self.start(command, MINIO_ROOT_USER="curvecast", MINIO_ROOT_PASSWORD=self.secret, MINIO_UPDATE="off", MINIO_BROWSER="off")
        if scheme == "http":
            wait_for(f"http://127.0.0.1:{port}/minio/health/live")
        else:
            wait_for_port(port)
        return port

    def start(self, command: list[str | pathlib.Path], **environment: str) -> None:
        # It ends with this process, however that ends.
        process = subprocess.Popen(
            ["setpriv", "--pdeathsig", "KILL", *command],
            env={**os.environ, "HOME": str(self.folder), **environment},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)

    def run_backend(self, tests: str, **environment: str) -> None:
        """What s3_live_test says: these tests of it, none of which may be skipped."""
        settings = {"AWS_ACCESS_KEY_ID": "curvecast", "AWS_SECRET_ACCESS_KEY": self.secret, "NO_PROXY": "127.0.0.1", **environment}
        done = subprocess.run(
            [os.environ["CURVECAST_S3_TEST"], f"--gtest_filter={tests}"],
            check=False,
            env={**os.environ, "HOME": str(self.folder), **settings},
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("SKIPPED", done.stdout)
        self.assertIn("PASSED", done.stdout)
        self.assertNotIn(self.secret, done.stdout + done.stderr)

    def test_the_backend(self) -> None:
        port = self.minio()
        self.run_backend("S3LiveTest.*", AWS_ENDPOINT_URL=f"http://127.0.0.1:{port}")

    def test_tls(self) -> None:
        certificates = self.folder / "certificates"
        certificates.mkdir()
        command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2"]
        command += ["-subj", "/CN=store", "-addext", "subjectAltName=IP:127.0.0.1"]
        command += ["-keyout", str(certificates / "private.key"), "-out", str(certificates / "public.crt")]
        subprocess.run(command, check=True, capture_output=True)
        port = self.minio("--certs-dir", str(certificates), scheme="https")
        endpoint = f"https://127.0.0.1:{port}"
        tests = "S3LiveTest.KeepsWhatStoresPromise"
        self.run_backend(tests, AWS_ENDPOINT_URL=endpoint, AWS_CA_BUNDLE=str(certificates / "public.crt"))
        with self.assertRaisesRegex(AssertionError, "certificate"):
            self.run_backend(tests, AWS_ENDPOINT_URL=endpoint)

    def test_bad_networks(self) -> None:
        port, proxied, control = self.minio(), free_port(), free_port()
        self.start([TOOLS / "toxiproxy", "-host", "127.0.0.1", "-port", str(control)])
        wait_for(f"http://127.0.0.1:{control}/version")
        proxy = {"name": "s3", "listen": f"127.0.0.1:{proxied}", "upstream": f"127.0.0.1:{port}", "enabled": True}
        request = urllib.request.Request(f"http://127.0.0.1:{control}/proxies", data=json.dumps(proxy).encode())
        urllib.request.urlopen(request, timeout=SECONDS).close()
        self.run_backend(
            "S3BadNetworkTest.*",
            AWS_ENDPOINT_URL=f"http://127.0.0.1:{port}",
            CURVECAST_S3_PROXIED=f"http://127.0.0.1:{proxied}",
            CURVECAST_TOXIPROXY=f"http://127.0.0.1:{control}/proxies/s3",
        )


def wait_for(url: str) -> None:
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        with contextlib.suppress(OSError):
            urllib.request.urlopen(url, timeout=SECONDS).close()
            return
        time.sleep(0.05)
    raise AssertionError(f"{url} does not answer")


def wait_for_port(port: int) -> None:
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=SECONDS):
            return
        time.sleep(0.05)
    raise AssertionError(f"nobody listens on port {port}")


if __name__ == "__main__":
    unittest.main()
