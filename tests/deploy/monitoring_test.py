"""deploy/monitoring beside what a server tells: rules and dashboard read metrics and labels that are there, every alert fires and
does not, and the runbook has a section for each."""

from __future__ import annotations

import http.client
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
from collections.abc import Iterator
from typing import Any, ClassVar

import yaml

import curvecast
import promql
from curvecast import Camera, View
from fixture import Server, sphere_obj
from hold.servers import eventually

DEPLOY = pathlib.Path(os.environ["CURVECAST_SOURCE"]) / "deploy"
MONITORING = DEPLOY / "monitoring"
#: What Prometheus adds to every series.
ADDED = {"job", "instance"}
#: Labels of a metric, and the values that each has.
Labels = dict[str, set[str]]


def rules() -> list[dict[str, Any]]:
    file = yaml.safe_load((MONITORING / "rules.yml").read_text())
    return [rule for group in file["groups"] for rule in group["rules"]]


def alerts() -> list[dict[str, Any]]:
    return [rule for rule in rules() if "alert" in rule]


def dashboard() -> dict[str, Any]:
    return dict(json.loads((MONITORING / "dashboard.json").read_text()))


def charts() -> list[dict[str, Any]]:
    return [panel for panel in dashboard()["panels"] if panel["type"] != "row"]


def parse(page: str) -> dict[str, Labels]:
    """The series of a page of metrics, by name."""
    metrics: dict[str, Labels] = {}
    for line in page.splitlines():
        if match := re.match(r"(\w+)(?:\{(.*)\})? \S+$", line):
            labels = metrics.setdefault(match[1], {})
            for label, value in re.findall(r'(\w+)="((?:\\.|[^"\\])*)"', match[2] or ""):
                labels.setdefault(label, set()).add(value)
    return metrics


class MonitoringTest(unittest.TestCase):
    #: What a server tells once it has done some of everything, what Prometheus says of it, and what rules record.
    metrics: ClassVar[dict[str, Labels]]

    @classmethod
    def setUpClass(cls) -> None:
        folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-monitoring-"))
        cls.addClassCleanup(shutil.rmtree, folder)
        (folder / "store").mkdir()
        places = ("--cache", str(folder / "cache"), "--store", f"file://{folder}/store")
        server = Server("--http", "none", "--admin", "127.0.0.1:0", *places)
        cls.addClassCleanup(server.stop)
        admin = server.output.readline().split()[-1]
        mesh = folder / "sphere.obj"
        mesh.write_text(sphere_obj())
        with curvecast.connect(server.address) as client:
            session = client.open(client.upload(mesh), points=1_000)
            with session.stream() as stream:
                stream.send(View(100, camera=Camera((0, 0, -4))))
                stream.frame(timeout=60)
        # What has no series before it happens, and may be counted after its client has heard of its end.
        wanted = {"curvecast_requests_total": "StreamViews", "curvecast_request_seconds_bucket": "StreamViews"}
        for _ in eventually(60):
            metrics = parse(get(admin, "/metrics"))
            if all(method in metrics.get(name, {}).get("method", set()) for name, method in wanted.items()):
                break
        metrics["up"] = {"job": {"curvecast"}}
        metrics.update({rule["record"]: {} for rule in rules() if "record" in rule})
        cls.metrics = metrics

    def assert_reads_what_is_there(self, where: str, expression: str, *texts: str) -> None:
        """`texts`: templates that name labels of the result."""
        read = list(promql.selectors(expression))
        self.assertTrue(read, where)
        known = set(ADDED)
        for selector in read:
            self.assertIn(selector.metric, self.metrics, where)
            labels = self.metrics[selector.metric]
            known |= labels.keys()
            for matcher in selector.matchers:
                self.assertIn(matcher.label, labels.keys() | ADDED, f"{where}: {selector.metric}")
                if matcher.operator == "=":
                    self.assertIn(matcher.value, labels.get(matcher.label, set()), f"{where}: {selector.metric}")
        self.assertLessEqual(promql.grouped_labels(expression), known, where)
        named = {label for text in texts for label in re.findall(r"\{\{\s*(?:\$labels\.)?(\w+)\s*\}\}", text)}
        self.assertLessEqual(named, known, where)

    def test_rules_read_metrics_that_are_there(self) -> None:
        for rule in rules():
            self.assert_reads_what_is_there(
                rule.get("alert") or rule["record"], rule["expr"], *rule.get("annotations", {}).values()
            )

    def test_the_dashboard_reads_metrics_that_are_there(self) -> None:
        for where, expression, legend in queries():
            self.assert_reads_what_is_there(where, expression, legend)
            self.assertIn("$instance", expression, where)

    def test_every_alert_has_a_section_of_the_runbook(self) -> None:
        sections = re.findall(r"^#+ (Curvecast\w+)$", (DEPLOY / "README.md").read_text(), re.MULTILINE)
        self.assertEqual(sections, [rule["alert"] for rule in alerts()])
        for rule in alerts():
            self.assertEqual(rule["annotations"]["runbook"], f"deploy/README.md#{rule['alert'].lower()}")
            self.assertIn(rule["labels"]["severity"], ("critical", "warning"))

    def test_every_alert_is_tested_firing_and_not_firing(self) -> None:
        tests = yaml.safe_load((MONITORING / "rules_test.yml").read_text())["tests"]
        cases = [case for test in tests for case in test.get("alert_rule_test", [])]
        for fires in (True, False):
            tested = {case["alertname"] for case in cases if bool(case.get("exp_alerts")) == fires}
            self.assertEqual(tested, {rule["alert"] for rule in alerts()}, f"firing: {fires}")

    def test_the_dashboard_is_in_order(self) -> None:
        board = dashboard()
        self.assertEqual([variable["name"] for variable in board["templating"]["list"]], ["datasource", "instance"])
        self.assertEqual(len({panel["id"] for panel in board["panels"]}), len(board["panels"]))
        taken: set[tuple[int, int]] = set()
        for panel in board["panels"]:
            place = panel["gridPos"]
            cells = {(place["x"] + x, place["y"] + y) for x in range(place["w"]) for y in range(place["h"])}
            self.assertFalse(cells & taken, panel["title"])
            self.assertLessEqual(place["x"] + place["w"], 24, panel["title"])
            taken |= cells
        for panel in charts():
            self.assertTrue(panel["title"] and panel["description"], panel)
            for target in panel["targets"]:
                self.assertEqual(target["datasource"], {"type": "prometheus", "uid": "${datasource}"}, panel["title"])

    def test_promtool_finds_nothing(self) -> None:
        self.run_promtool("check", "config", str(MONITORING / "prometheus.yml"))
        self.run_promtool("check", "rules", str(MONITORING / "rules.yml"))
        self.run_promtool("test", "rules", str(MONITORING / "rules_test.yml"))

    def test_promtool_understands_the_dashboard(self) -> None:
        written = [
            {"record": f"dashboard:{number}", "expr": expression.replace("$__rate_interval", "1m").replace("$instance", ".*")}
            for number, (_, expression, _) in enumerate(queries())
        ]
        with tempfile.NamedTemporaryFile("w", suffix=".yml") as file:
            json.dump({"groups": [{"name": "dashboard", "rules": written}]}, file)
            file.flush()
            self.run_promtool("check", "rules", file.name)

    def run_promtool(self, *arguments: str) -> None:
        if shutil.which("promtool") is None:
            self.skipTest("there is no promtool: deploy/setup --checks installs it, with Debian's package prometheus")
        done = subprocess.run(["promtool", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)


def get(address: str, path: str) -> str:
    connection = http.client.HTTPConnection(address, timeout=60)
    try:
        connection.request("GET", path)
        return connection.getresponse().read().decode()
    finally:
        connection.close()


def queries() -> Iterator[tuple[str, str, str]]:
    """Of the dashboard: where, the expression, and the legend or title that names labels."""
    for panel in charts():
        for target in panel["targets"]:
            yield panel["title"], target["expr"], target["legendFormat"]
    for annotation in dashboard()["annotations"]["list"]:
        if "expr" in annotation:
            yield annotation["name"], annotation["expr"], annotation["titleFormat"]


if __name__ == "__main__":
    unittest.main()
