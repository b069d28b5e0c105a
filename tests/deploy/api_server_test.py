"""deploy/helm before a real Kubernetes API server, with etcd behind it and nothing that runs pods: what Helm installs, changes and
removes there. `deploy/check_helm --api-server` runs it."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import ssl
import subprocess
import tempfile
import unittest
import urllib.error
import urllib.request
from typing import Any, ClassVar

import yaml
from free_port import free_port

import helm_chart
from helm_chart import CHART, OPTIONS, TOOLS, Object, Outcome, eventually, workloads

PATIENCE = 180.0  # seconds; only a broken server takes that long to be ready
TOKEN = "nobody-else-reaches-it"
CLASSES = "/apis/scheduling.k8s.io/v1/priorityclasses"
RESTRICTED = {"pod-security.kubernetes.io/enforce": "restricted", "pod-security.kubernetes.io/enforce-version": "v1.30"}


class ApiServer:
    def __init__(self) -> None:
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-kubernetes-"))
        port = free_port()
        self.address = f"https://127.0.0.1:{port}"
        tokens = self.folder / "tokens.csv"
        tokens.write_text(f'{TOKEN},admin,admin,"system:masters"\n')
        key = self.folder / "accounts.key"
        subprocess.run(["openssl", "genrsa", "-out", str(key), "2048"], capture_output=True, check=True)
        self._log = open(self.folder / "log", "wb")  # noqa: SIM115 (as long as the server)
        self._process = subprocess.Popen(
            [
                *(str(TOOLS / "api_server"), str(self.folder), str(free_port())),
                *("--bind-address", "127.0.0.1", "--secure-port", str(port), "--cert-dir", str(self.folder)),
                *("--token-auth-file", str(tokens), "--authorization-mode", "RBAC", "--allow-privileged"),
                *("--service-cluster-ip-range", "10.0.0.0/24", "--service-account-issuer", self.address),
                *("--service-account-key-file", str(key), "--service-account-signing-key-file", str(key)),
                *("--disable-admission-plugins", "ServiceAccount"),  # nobody makes them here
            ],
            stdout=self._log,
            stderr=self._log,
        )
        try:
            self._wait_until_ready()
        except BaseException:
            self.close()
            raise
        self.settings = self.folder / "kubeconfig"
        cluster = {"server": self.address, "certificate-authority": str(self.folder / "apiserver.crt")}
        self.settings.write_text(
            yaml.safe_dump(
                {
                    "apiVersion": "v1",
                    "kind": "Config",
                    "clusters": [{"name": "here", "cluster": cluster}],
                    "users": [{"name": "admin", "user": {"token": TOKEN}}],
                    "contexts": [{"name": "here", "context": {"cluster": "here", "user": "admin"}}],
                    "current-context": "here",
                }
            )
        )

    def close(self) -> None:
        self._process.terminate()
        self._process.wait()
        self._log.close()
        shutil.rmtree(self.folder)

    def _wait_until_ready(self) -> None:
        for _ in eventually(PATIENCE):
            try:
                if self.ask("GET", "/readyz", raw=True)[0] == 200:
                    return
            except OSError:
                pass  # it does not listen yet, or has no certificate
            if self._process.poll() is not None:
                raise RuntimeError("the API server has ended:\n" + (self.folder / "log").read_text()[-4000:])

    def ask(self, method: str, path: str, body: Object | None = None, raw: bool = False) -> tuple[int, Any]:
        """The status and the answer, which is JSON unless `raw`. Also where that is an error."""
        request = urllib.request.Request(
            self.address + path,
            method=method,
            data=None if body is None else json.dumps(body).encode(),
            headers={"Authorization": f"Bearer {TOKEN}", "Content-Type": "application/json"},
        )
        trusted = ssl.create_default_context(cafile=str(self.folder / "apiserver.crt"))
        try:
            with urllib.request.urlopen(request, context=trusted, timeout=60) as answer:
                status, text = answer.status, answer.read()
        except urllib.error.HTTPError as error:
            status, text = error.code, error.read()
        return status, text if raw else json.loads(text)

    def make_namespace(self, name: str) -> None:
        status, answer = self.ask("POST", "/api/v1/namespaces", {"metadata": {"name": name, "labels": RESTRICTED}})
        if status != 201:
            raise AssertionError(answer)

    def helm(self, *arguments: str, namespace: str) -> Outcome:
        return helm_chart.helm(*arguments, "--kubeconfig", str(self.settings), "--namespace", namespace)


class ApiServerTest(helm_chart.Rendered):
    server: ClassVar[ApiServer]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.server = ApiServer()
        cls.addClassCleanup(cls.server.close)
        for path in os.environ["KUBERNETES_CRDS"].split(os.pathsep):
            for definition in yaml.safe_load_all(pathlib.Path(path).read_text()):
                status, answer = cls.server.ask("POST", "/apis/apiextensions.k8s.io/v1/customresourcedefinitions", definition)
                if status != 201:
                    raise AssertionError(f"{path}: {answer}")

    def path_of(self, thing: Object, namespace: str) -> str:
        """Where things of its kind are."""
        group, kind = thing["apiVersion"], thing["kind"]
        base = f"/apis/{group}" if "/" in group else f"/api/{group}"
        for _ in eventually(PATIENCE):  # what a definition brings is there a moment after it
            _, found = self.server.ask("GET", base)
            for resource in found.get("resources", []):
                if resource["kind"] == kind and "/" not in resource["name"]:
                    return (
                        f"{base}/namespaces/{namespace}/{resource['name']}"
                        if resource["namespaced"]
                        else f"{base}/{resource['name']}"
                    )
        raise AssertionError(f"no {kind} of {group}")

    def test_every_object_is_taken_without_an_unknown_field(self) -> None:
        self.server.make_namespace("strict")
        for name, objects in self.objects.items():
            for thing in objects:
                path = self.path_of(thing, "strict") + "?dryRun=All&fieldValidation=Strict"
                here = {**thing, "metadata": {**thing["metadata"], "namespace": "strict"}}
                status, answer = self.server.ask("POST", path, here)
                self.assertEqual(status, 201, f"{name}: {thing['kind']} {thing['metadata']['name']}: {answer}")

    def test_pods_are_restricted(self) -> None:
        self.server.make_namespace("restricted")
        path = "/api/v1/namespaces/restricted/pods?dryRun=All&fieldValidation=Strict"
        for name, objects in self.objects.items():
            for workload in workloads(objects):
                template = workload["spec"]["template"]
                claims = [claim["metadata"]["name"] for claim in workload["spec"].get("volumeClaimTemplates", [])]
                spec = dict(template["spec"])
                spec["volumes"] = [*spec.get("volumes", []), *({"name": claim, "emptyDir": {}} for claim in claims)]
                if "priorityClassName" in spec:  # the operator's
                    self.server.ask("POST", CLASSES, {"metadata": {"name": spec["priorityClassName"]}, "value": 1000})
                pod = {"metadata": {**template["metadata"], "name": "one"}, "spec": spec}
                status, answer = self.server.ask("POST", path, pod)
                self.assertEqual(status, 201, f"{name}: {workload['kind']}: {answer}")
        spec["securityContext"] = {"runAsUser": 0}
        status, answer = self.server.ask("POST", path, pod)
        self.assertEqual((status, answer["reason"]), (403, "Forbidden"), "nobody looks")

    def test_helm_installs_changes_and_removes(self) -> None:
        for name in self.options:
            self.server.make_namespace(name)
            options = ("--values", str(OPTIONS / f"{name}.yaml"))
            done = self.server.helm("install", "curvecast", str(CHART), *options, namespace=name)
            self.assertEqual(done.status, 0, f"{name}: {done.errors}")
            # What operators change without making it anew.
            changed = ("--set", "image.tag=0.2.0,settings.max-sessions=77")
            done = self.server.helm("upgrade", "curvecast", str(CHART), *options, *changed, namespace=name)
            self.assertEqual(done.status, 0, f"{name}: {done.errors}")
            status, answer = self.server.ask("GET", f"/apis/apps/v1/namespaces/{name}/statefulsets")
            self.assertEqual(status, 200, answer)
            (servers,) = answer["items"]
            (container,) = servers["spec"]["template"]["spec"]["containers"]
            self.assertTrue(container["image"].endswith(":0.2.0"), container["image"])
            self.assertIn({"name": "CURVECAST_MAX_SESSIONS", "value": "77"}, container["env"])
            done = self.server.helm("rollback", "curvecast", "1", namespace=name)
            self.assertEqual(done.status, 0, f"{name}: {done.errors}")
            done = self.server.helm("uninstall", "curvecast", namespace=name)
            self.assertEqual(done.status, 0, f"{name}: {done.errors}")
            for kind in ("statefulsets", "deployments"):
                _, answer = self.server.ask("GET", f"/apis/apps/v1/namespaces/{name}/{kind}")
                self.assertEqual([thing["metadata"]["name"] for thing in answer["items"]], [], "stays")


if __name__ == "__main__":
    unittest.main()
