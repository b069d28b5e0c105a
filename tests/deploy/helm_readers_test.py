"""What Helm makes of deploy/helm with every option, given to those who are to read it: HAProxy, the server, Prometheus.
deploy/check_helm runs it."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import subprocess
import unittest
from typing import Any

import yaml

import helm_chart
from helm_chart import CHART, NAMESPACE, SOURCE, Object, container, environment, find, folder_of, workloads
from serve_settings import expected, setting_name, settings

#: Settings of `serve` that an operator of the chart has no use for.
UNUSED = {"seed"}


class ReadersTest(helm_chart.Rendered):
    # HAProxy

    def test_haproxy_takes_its_settings(self) -> None:
        haproxy = shutil.which("haproxy") or "/usr/sbin/haproxy"
        if not os.access(haproxy, os.X_OK):
            self.skipTest("there is no haproxy: deploy/setup --cluster installs it")
        gateways = 0
        for name, objects in self.objects.items():
            for work in workloads(objects):
                if work["kind"] == "Deployment":
                    gateways += 1
                    self.run_haproxy(haproxy, folder_of(self), work, objects, name)
        self.assertGreaterEqual(gateways, 2)

    def run_haproxy(self, haproxy: str, folder: pathlib.Path, work: Object, objects: list[Object], name: str) -> None:
        """With what its pod would find, at other places."""
        only = container(work)
        places: dict[str, str] = {}
        for mount in only["volumeMounts"]:
            place = folder / mount["name"]
            place.mkdir()
            places[mount["mountPath"]] = str(place)
            volume = next(it for it in work["spec"]["template"]["spec"]["volumes"] if it["name"] == mount["name"])
            if "configMap" in volume:
                for file, text in find(objects, "ConfigMap", volume["configMap"]["name"])["data"].items():
                    (place / file).write_text(text)
            if "secret" in volume:
                certificate = {"tls.crt": folder / "tls.crt", "tls.key": folder / "tls.key"}
                make_certificate(*certificate.values())
                for item in volume["secret"]["items"]:
                    shutil.copy(certificate[item["key"]], place / item["path"])

        def here(text: str) -> str:
            for path, place in sorted(places.items(), reverse=True):
                text = re.sub(rf"^{path}(?=/|$)", place, text)
            return text

        command = [haproxy, "-c", *(here(argument) for argument in only["command"][1:])]
        variables = {key: here(value) for key, value in environment(work).items()}
        done = subprocess.run(command, env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{name}: {done.stdout}")
        self.assertNotRegex(done.stdout, "WARNING|ALERT")
        # The same servers with the same places in both, as many as there may be.
        config = find(objects, "ConfigMap", work["metadata"]["name"])["data"]["replicas.cfg"]
        servers = re.findall(r"^  server (\S+) (\S+):(\d+) id (\d+)$", config, re.MULTILINE)
        stateful = find(objects, "StatefulSet")
        scaler = [it["spec"]["maxReplicas"] for it in objects if it["kind"] == "HorizontalPodAutoscaler"]
        count = scaler[0] if scaler else stateful["spec"]["replicas"]
        # Only with a store, or one cache for all, may the next server help.
        is_shared = "CURVECAST_STORE" in environment(stateful) or any(
            "persistentVolumeClaim" in volume
            for volume in stateful["spec"]["template"]["spec"]["volumes"]
            if volume["name"] == "cache"
        )
        self.assertEqual(config.count("hash-balance-factor 0"), 0 if is_shared else 2, name)
        domain = f"{stateful['spec']['serviceName']}.{NAMESPACE}.svc."
        for port, part in zip(("50051", "8080"), (servers[:count], servers[count:]), strict=True):
            self.assertEqual([each[0] for each in part], [f"{stateful['metadata']['name']}-{i}" for i in range(count)])
            for pod, address, to, place in part:
                self.assertTrue(address.startswith(f"{pod}.{domain}"), address)
                self.assertEqual((to, int(place)), (port, int(pod.rpartition("-")[2]) + 1))

    # The server

    def test_the_server_takes_its_settings(self) -> None:
        command = helm_chart.command_of(self)
        named = set()
        for name, objects in self.objects.items():
            every = environment(find(objects, "StatefulSet"))  # those of the store too, which are no settings
            variables = {variable: value for variable, value in every.items() if variable.startswith("CURVECAST_")}
            printed = settings(command, variables)
            self.assertEqual(container(find(objects, "StatefulSet"))["args"], ["serve"])
            for variable, value in variables.items():
                setting = setting_name(variable)
                named.add(setting)
                self.assertIn(setting, printed, name)
                self.assertEqual(printed[setting], expected(value), f"{name}: {setting}")
        schema = json.loads((CHART / "values.schema.json").read_text())["properties"]["settings"]["properties"]
        known = set(settings(command, {}))
        self.assertEqual(known - named - UNUSED, set(), "no option of the chart sets them")
        self.assertEqual(set(schema) - known, set())
        self.assertEqual(set(schema) - named, set(), "no file of tests/deploy/helm sets them")

    def test_the_server_takes_its_tokens(self) -> None:
        file = folder_of(self) / "tokens"
        file.write_text(find(self.objects["everything"], "Secret")["stringData"]["tokens"])
        # It ends with this process, however that ends.
        command = ["setpriv", "--pdeathsig", "TERM", helm_chart.command_of(self), "serve", "--tokens", str(file)]
        command += ["--listen", "127.0.0.1:0", "--http", "none"]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert server.stdout is not None
        line = server.stdout.readline()
        server.terminate()
        errors = server.communicate(timeout=60)[1]
        self.assertTrue(line.startswith("listening on "), errors)
        self.assertEqual(server.returncode, 0, errors)

    # Prometheus

    def test_metrics_of_the_autoscaler_are_there(self) -> None:
        rule = self.adapter_rule()
        self.assertEqual(rule["name"]["as"], helm_chart.defaults()["autoscaling"]["viewWait"]["metric"])
        told = (SOURCE / "server/engine/metrics.cpp").read_text()
        read = re.findall(r"(curvecast_\w+?)(?:_bucket|_count)\b", rule["seriesQuery"] + rule["metricsQuery"])
        self.assertEqual(set(read), {"curvecast_view_wait_seconds"})
        self.assertIn(f'"{read[0]}"', told)

    def test_the_autoscaler_is_told_of_the_slowest_tenth(self) -> None:
        """One pod whose views waited for 25 to 50 ms, one that had none."""
        if shutil.which("promtool") is None:
            self.skipTest("there is no promtool: deploy/setup --checks installs it, with Debian's package prometheus")
        rule = self.adapter_rule()
        query = rule["metricsQuery"].replace("<<.Series>>", "curvecast_view_wait_seconds_bucket")
        query = query.replace("<<.LabelMatchers>>", 'namespace="scans",pod=~"a|b"').replace("<<.GroupBy>>", "pod")
        name = "curvecast_view_wait_seconds"
        counts = {
            "a": {"0.025": "0+0x9", "0.05": "0+100x9", "+Inf": "0+100x9"},
            "b": {"0.025": "7+0x9", "0.05": "7+0x9", "+Inf": "7+0x9"},
        }
        series = [
            {"series": f'{name}_bucket{{namespace="scans",pod="{pod}",le="{edge}"}}', "values": values}
            for pod, edges in counts.items()
            for edge, values in edges.items()
        ]
        series += [
            {"series": f'{name}_count{{namespace="scans",pod="{pod}"}}', "values": edges["+Inf"]} for pod, edges in counts.items()
        ]
        wanted = [{"labels": '{pod="a"}', "value": 0.0475}, {"labels": '{pod="b"}', "value": 0}]
        case = {"expr": query, "eval_time": "5m", "exp_samples": wanted}
        file = folder_of(self) / "test.yml"
        file.write_text(json.dumps({"tests": [{"interval": "1m", "input_series": series, "promql_expr_test": [case]}]}))
        done = subprocess.run(["promtool", "test", "rules", file], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def adapter_rule(self) -> dict[str, Any]:
        (rule,) = yaml.safe_load((CHART / "examples/prometheus-adapter.yaml").read_text())["rules"]["custom"]
        return dict(rule)


def make_certificate(certificate: pathlib.Path, key: pathlib.Path) -> None:
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=localhost"]
    subprocess.run([*command, "-keyout", key, "-out", certificate], check=True, capture_output=True)


if __name__ == "__main__":
    unittest.main()
