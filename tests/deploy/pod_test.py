"""A server's pod of deploy/helm, truly run: by podman, with the image that deploy/image has made. `deploy/check_helm --pod` runs
it."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import time
import unittest
from typing import Any

import yaml
from free_port import free_port

import helm_chart
from helm_chart import Object, Values, command_of, eventually, find, folder_of

IMAGE = "localhost/curvecast:latest"
VALUES: Values = {
    "openToAll": True,
    "image": {"repository": "localhost/curvecast", "tag": "latest", "pullPolicy": "Never"},
    "resources": {"requests": {"cpu": "1", "memory": "512Mi"}, "limits": {"cpu": "1", "memory": "512Mi"}},
}
NAME, CLAIM = "curvecast-check-0", "curvecast-check-cache"
CONTAINER = f"{NAME}-curvecast"


def pod_of(servers: Object) -> list[Object]:
    """The first one, after its claim, as Kubernetes makes them of a StatefulSet, which podman does not know. Its ports are on free
    ones of the loopback."""
    template = servers["spec"]["template"]
    spec = template["spec"]
    (claim,) = servers["spec"]["volumeClaimTemplates"]
    spec["volumes"].append({"name": claim["metadata"]["name"], "persistentVolumeClaim": {"claimName": CLAIM}})
    for port in helm_chart.container(servers)["ports"]:
        port.update(hostIP="127.0.0.1", hostPort=free_port())
    kinds = {"apiVersion": "v1", "metadata": {"name": CLAIM}, "kind": "PersistentVolumeClaim", "spec": claim["spec"]}
    return [kinds, {"apiVersion": "v1", "kind": "Pod", "metadata": {**template["metadata"], "name": NAME}, "spec": spec}]


def field(size: int) -> str:
    """An OFF file: a field of so many bumps each way, two triangles between four of them."""
    lines = [f"OFF\n{size * size} {2 * (size - 1) ** 2} 0"]
    lines += [f"{x} {y} {x * y % 3}" for x in range(size) for y in range(size)]
    for corner in (x * size + y for x in range(size - 1) for y in range(size - 1)):
        lines += [f"3 {corner} {corner + size} {corner + 1}", f"3 {corner + 1} {corner + size} {corner + size + 1}"]
    return "\n".join([*lines, ""])


class PodTest(unittest.TestCase):
    def setUp(self) -> None:
        self.command = command_of(self)
        self.folder = folder_of(self)
        # No more files and processes than who runs this may give, as in deploy/container/check.
        settings = self.folder / "containers.conf"
        settings.write_text('[containers]\ndefault_ulimits = ["nofile=4096:4096", "nproc=1024:1024"]\n')
        self.environment = {**os.environ, "CONTAINERS_CONF": os.environ.get("CONTAINERS_CONF", str(settings))}
        outcome = helm_chart.template(VALUES)
        self.assertEqual(outcome.status, 0, outcome.errors)
        claim, pod = pod_of(find(outcome.objects(), "StatefulSet"))
        self.ports = {port["name"]: port["hostPort"] for port in pod["spec"]["containers"][0]["ports"]}
        self.file, claims = self.folder / "pod.yaml", self.folder / "claim.yaml"
        self.file.write_text(yaml.safe_dump(pod))
        claims.write_text(yaml.safe_dump(claim))
        self.assertTrue(self.podman("image", "exists", IMAGE, check=False)[0], f"there is no {IMAGE}: run deploy/image")
        self.addCleanup(self.podman, "volume", "rm", "--force", CLAIM, check=False)
        self.addCleanup(self.podman, "kube", "down", str(self.file), check=False)
        self.podman("kube", "play", str(claims))

    def podman(self, *arguments: str, check: bool = True) -> tuple[bool, str]:
        done = subprocess.run(["podman", *arguments], env=self.environment, capture_output=True, text=True, check=False)
        if check:
            self.assertEqual(done.returncode, 0, f"podman {arguments}: {done.stdout}{done.stderr}")
        return done.returncode == 0, done.stdout

    def inspect(self, what: str) -> Any:
        return json.loads(self.podman("inspect", "--format", f"{{{{json {what}}}}}", CONTAINER)[1])

    def play(self) -> None:
        self.podman("kube", "play", str(self.file))
        for _ in eventually():
            if self.podman("exec", CONTAINER, "/usr/bin/curvecast", "health", check=False)[0]:
                break

    def sample(self) -> str:
        """What the command says while it samples a mesh there."""
        mesh = self.folder / "field.off"
        mesh.write_text(field(20))
        command = [self.command, "sample", str(mesh), "--server", f"127.0.0.1:{self.ports['grpc']}"]
        done = subprocess.run(
            [*command, "-n", "1000", "-o", str(self.folder / "points.ply")], capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def test_serves_without_rights_ends_in_order_and_goes_on_from_its_volume(self) -> None:
        self.play()
        status = pathlib.Path(f"/proc/{self.inspect('.State.Pid')}/status").read_text()
        for line in ("Uid:\t65532\t65532\t65532\t65532", "CapEff:\t0000000000000000", "NoNewPrivs:\t1", "Seccomp:\t2"):
            self.assertIn(line, status)
        self.assertTrue(self.inspect(".HostConfig.ReadonlyRootfs"))
        self.assertEqual(self.inspect(".HostConfig.Memory"), 512 << 20)
        self.assertIn("parameterise", self.sample())
        begin = time.monotonic()
        self.podman("pod", "kill", "--signal", str(int(signal.SIGTERM)), NAME)
        self.podman("wait", CONTAINER)
        self.assertEqual(self.inspect(".State.ExitCode"), 0)
        self.assertLess(time.monotonic() - begin, 50, "of its grace")
        self.podman("kube", "down", str(self.file))
        self.play()
        self.assertNotIn("parameterise", self.sample(), "made again, though its volume has it")


if __name__ == "__main__":
    unittest.main()
