"""deploy/compose beside the files that it names, the image that it runs, and those who read all of these: the server, HAProxy,
Prometheus."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
from typing import Any, ClassVar

import yaml

from serve_settings import expected, setting_name, settings

DEPLOY = pathlib.Path(os.environ["CURVECAST_SOURCE"]) / "deploy"
COMPOSE = DEPLOY / "compose"
STORE_SETTINGS = DEPLOY.parent / "server" / "store" / "s3_settings.cpp"
COMMAND = os.environ["CURVECAST_COMMAND"]
SERVERS = ["curvecast-1", "curvecast-2", "curvecast-3"]


def variables() -> dict[str, str]:
    """Of .env."""
    return dict(re.findall(r"^([A-Z_]+)=(.*)$", (COMPOSE / ".env").read_text(), re.MULTILINE))


def dockerfile() -> list[tuple[str, str]]:
    """Instructions of the stage `curvecast`, in order."""
    text = re.sub(r"^#.*\n", "", (DEPLOY / "container/Dockerfile").read_text(), flags=re.MULTILINE).replace("\\\n", " ")
    stage = re.search(r"^FROM scratch AS curvecast\n(.*?)(?=^FROM|\Z)", text, re.MULTILINE | re.DOTALL)
    assert stage is not None
    return [(name, value.strip()) for name, value in re.findall(r"^([A-Z]+)\s+(.*)$", stage[1], re.MULTILINE)]


def instruction(name: str) -> str:
    (value,) = (value for key, value in dockerfile() if key == name)
    return value


def image_environment() -> dict[str, str]:
    return dict(pair.split("=", 1) for pair in instruction("ENV").split())


def port(variable: str) -> int:
    return int(image_environment()[variable].rpartition(":")[2])


class ComposeTest(unittest.TestCase):
    services: ClassVar[dict[str, dict[str, Any]]]
    file: ClassVar[dict[str, Any]]

    @classmethod
    def setUpClass(cls) -> None:
        known = variables()
        text = (COMPOSE / "compose.yaml").read_text()
        # Every one of them has a value, and every value is one of them.
        assert set(re.findall(r"\$\{(\w+)\}", text)) == set(known), known
        cls.file = yaml.safe_load(re.sub(r"\$\{(\w+)\}", lambda match: known[match[1]], text))
        cls.services = cls.file["services"]

    def mounts(self, service: str) -> dict[str, pathlib.Path]:
        """Files of the project, by their places in the container."""
        found = {}
        for mount in self.services[service]["volumes"]:
            source, place, *mode = mount.split(":")
            if source.startswith("."):
                self.assertEqual(mode, ["ro"], mount)
                found[place] = (COMPOSE / source).resolve()
            else:
                self.assertIn(source, self.file["volumes"], mount)
        return found

    def environment(self, service: str) -> dict[str, str]:
        return {name: str(value) for name, value in self.services[service]["environment"].items()}

    def test_files_are_there(self) -> None:
        named = {path for service in self.services for path in self.mounts(service).values()}
        for path in named:
            self.assertTrue(path.is_file(), path)
        own = {path for path in COMPOSE.rglob("*") if path.is_file()}
        self.assertEqual(own - named, {COMPOSE / "compose.yaml", COMPOSE / ".env"}, "nothing reads them")

    def test_nobody_has_rights(self) -> None:
        for name, service in self.services.items():
            self.assertIs(service["read_only"], True, name)
            self.assertEqual(service["cap_drop"], ["ALL"], name)
            self.assertEqual(service["security_opt"], ["no-new-privileges:true"], name)
            for published in service.get("ports", []):
                self.assertTrue(published.startswith("127.0.0.1:"), published)
        for name in SERVERS:
            self.assertNotIn("ports", self.services[name])

    def test_the_server_takes_its_settings(self) -> None:
        own = image_environment()
        for name in SERVERS:
            given = self.environment(name)
            self.assertFalse(own.keys() & given.keys(), "said twice")
            every = {**own, **given}
            printed = settings(COMMAND, every)
            for variable, value in every.items():
                if variable.startswith("AWS_"):  # the store's, which are no options
                    self.assertIn(f'"{variable}"', STORE_SETTINGS.read_text())
                else:
                    self.assertEqual(printed[setting_name(variable)], expected(value), variable)
            # It has the time to end well.
            grace = int(self.services[name]["stop_grace_period"].removesuffix("s"))
            self.assertGreater(grace, sum(float(printed[part]) for part in ("lame-duck", "drain", "max-stop-time")))

    def test_the_image_runs_the_command(self) -> None:
        self.assertEqual(instruction("USER"), "65532:65532")
        self.assertEqual(json.loads(instruction("ENTRYPOINT")), ["/usr/bin/curvecast"])
        self.assertEqual(instruction("STOPSIGNAL"), "SIGTERM")
        self.assertEqual(instruction("VOLUME"), image_environment()["CURVECAST_CACHE"])
        self.assertEqual(json.loads(instruction("CMD")), ["serve"])
        for name in SERVERS:
            self.assertFalse(self.services[name].keys() & {"command", "entrypoint", "user", "healthcheck", "stop_signal"})
        exposed = {int(number) for number in instruction("EXPOSE").split()}
        self.assertEqual(exposed, {port(f"CURVECAST_{name}") for name in ("LISTEN", "HTTP", "ADMIN")})
        program, *arguments = json.loads(instruction("HEALTHCHECK").partition(" CMD ")[2])
        self.assertEqual(program, "/usr/bin/curvecast")
        done = subprocess.run([COMMAND, *arguments, "--help"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        # Where it looks if it is not told.
        self.assertIn(f"default: 127.0.0.1:{port('CURVECAST_LISTEN')}", re.sub(r"\s+", " ", done.stdout))

    def test_haproxy_knows_the_servers(self) -> None:
        text = self.mounts("proxy")["/etc/curvecast/replicas.cfg"].read_text()
        for backend, variable in (("grpc", "CURVECAST_LISTEN"), ("http", "CURVECAST_HTTP")):
            section = re.search(rf"^backend {backend} .*\n((?:  .*\n)*)", text, re.MULTILINE)
            assert section is not None
            self.assertRegex(section[1], rf"default-server .* port {port('CURVECAST_ADMIN')}\n")
            found = re.findall(r"server (\S+) (\S+):(\d+) id (\d+)", section[1])
            wanted = [(f"r{i}", name, str(port(variable)), str(i)) for i, name in enumerate(SERVERS, 1)]
            self.assertEqual(found, wanted, backend)
        for published in self.services["proxy"]["ports"]:
            self.assertRegex((DEPLOY / "haproxy/haproxy.cfg").read_text(), rf"presetenv EDGE_\w+ :{published.rpartition(':')[2]}\n")

    def test_haproxy_takes_its_settings(self) -> None:
        haproxy = shutil.which("haproxy") or "/usr/sbin/haproxy"
        if not os.access(haproxy, os.X_OK):
            self.skipTest("there is no haproxy: deploy/setup --cluster installs it")
        places = self.mounts("proxy")
        _, *arguments = self.services["proxy"]["command"]
        command = [haproxy, "-c", *(str(places.get(argument, argument)) for argument in arguments)]
        done = subprocess.run(
            command, env=self.environment("proxy"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stdout)
        # Names are those of the containers' network.
        self.assertNotRegex(done.stdout, "ALERT|WARNING(?!.* could not resolve address 'curvecast-)")

    def test_prometheus_asks_the_servers(self) -> None:
        places = self.mounts("prometheus")
        told = yaml.safe_load(places["/etc/prometheus/prometheus.yml"].read_text())
        jobs = {job["job_name"]: job["static_configs"][0]["targets"] for job in told["scrape_configs"]}
        self.assertEqual(jobs["curvecast"], [f"{name}:{port('CURVECAST_ADMIN')}" for name in SERVERS])
        admin = self.environment("proxy")["EDGE_ADMIN"].rpartition(":")[2]
        self.assertEqual(jobs["haproxy"], [f"proxy:{admin}"])
        rules = [f"/etc/prometheus/{name}" for name in told["rule_files"]]
        self.assertEqual([places[rule] for rule in rules], [DEPLOY / "monitoring/rules.yml"])

    def test_promtool_takes_its_settings(self) -> None:
        if shutil.which("promtool") is None:
            self.skipTest("there is no promtool: deploy/setup --checks installs it, with Debian's package prometheus")
        with tempfile.TemporaryDirectory(prefix="curvecast-compose-") as folder:
            for place, path in self.mounts("prometheus").items():
                shutil.copy(path, pathlib.Path(folder) / pathlib.Path(place).name)
            command = ["promtool", "check", "config", f"{folder}/prometheus.yml"]
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertRegex(done.stdout, r"[1-9]\d* rules found")

    def test_grafana_has_the_dashboard_and_its_data(self) -> None:
        places = self.mounts("grafana")
        provisioning = "/etc/grafana/provisioning"
        (source,) = yaml.safe_load(places[f"{provisioning}/datasources/curvecast.yml"].read_text())["datasources"]
        inside = self.services["prometheus"]["ports"][0].rpartition(":")[2]
        self.assertEqual(source["url"], f"http://prometheus:{inside}")
        scraped = yaml.safe_load(self.mounts("prometheus")["/etc/prometheus/prometheus.yml"].read_text())["global"]
        self.assertEqual(source["jsonData"]["timeInterval"], scraped["scrape_interval"])
        (provider,) = yaml.safe_load(places[f"{provisioning}/dashboards/curvecast.yml"].read_text())["providers"]
        boards = [place for place in places if place.startswith(provider["options"]["path"] + "/")]
        self.assertEqual(boards, [self.environment("grafana")["GF_DASHBOARDS_DEFAULT_HOME_DASHBOARD_PATH"]])
        board = json.loads(places[boards[0]].read_text())
        (choice,) = (each for each in board["templating"]["list"] if each["type"] == "datasource")
        self.assertEqual((choice["query"], source["isDefault"]), (source["type"], True))


if __name__ == "__main__":
    unittest.main()
