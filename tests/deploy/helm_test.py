"""deploy/helm: what Helm makes of it with every option, beside what Kubernetes takes; and what it refuses. deploy/check_helm runs
it."""

from __future__ import annotations

import copy
import json
import pathlib
import re
import subprocess
import unittest
from collections.abc import Callable
from typing import Any

import yaml

import helm_chart
from helm_chart import CHART, NAMESPACE, SOURCE, TOOLS, Object, at, container, environment, find, folder_of, workloads

SCHEMAS = SOURCE / "build/helm/schemas"


def kubeconform(*files: pathlib.Path) -> dict[str, Any]:
    command = [str(TOOLS / "kubeconform"), "-strict", "-summary", "-output", "json"]
    command += ["-schema-location", f"{SCHEMAS}/{{{{.ResourceKind}}}}{{{{.KindSuffix}}}}.json", *map(str, files)]
    return dict(json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout))


class HelmTest(helm_chart.Rendered):
    # What is covered

    def test_helm_finds_nothing(self) -> None:
        files = [path for path in helm_chart.OPTIONS.glob("*.yaml") if path.stem != "refused"]
        for arguments in ([], *(["--values", str(path)] for path in files)):
            outcome = helm_chart.helm("lint", "--strict", str(CHART), *arguments)
            self.assertEqual(outcome.status, 0, outcome.text + outcome.errors)
            self.assertNotRegex(outcome.text, r"\[(WARNING|ERROR)\]")

    def test_every_value_is_tried_and_does_something(self) -> None:
        said = {path for values in self.options.values() for path, _ in helm_chart.leaves(values)}
        known = {path for path, _ in helm_chart.leaves(helm_chart.defaults())}
        self.assertEqual(known - said, set(), "no file of tests/deploy/helm has them")
        for path in sorted(said):
            where = [name for name, values in self.options.items() if at(values, path) is not None] or [
                name for name, values in self.options.items() if path in dict(helm_chart.leaves(values))
            ]
            self.assertTrue(
                any(
                    helm_chart.template(helm_chart.without(self.options[name], path)).text != self.rendered[name].text
                    for name in where
                ),
                f"{'.'.join(path)} of {where} changes nothing",
            )

    def test_every_switch_is_tried_on_and_off(self) -> None:
        for path, value in helm_chart.leaves(helm_chart.defaults()):
            if isinstance(value, bool):
                tried = {value if at(values, path) is None else at(values, path) for values in self.options.values()}
                self.assertEqual(tried, {True, False}, ".".join(path))

    def test_what_has_no_sense_is_refused(self) -> None:
        for case in helm_chart.refused():
            outcome = helm_chart.template(case["values"])
            self.assertNotEqual(outcome.status, 0, case)
            self.assertIn(case["says"], outcome.errors)

    def test_every_rule_of_the_chart_is_tried(self) -> None:
        rules = re.findall(r'fail "([^"]+)"', (CHART / "templates/_helpers.tpl").read_text())
        said = [case["says"] for case in helm_chart.refused()]
        for rule in rules:
            self.assertTrue(any(text in rule for text in said), rule)

    def test_the_schema_knows_the_values_and_nothing_else(self) -> None:
        schema = json.loads((CHART / "values.schema.json").read_text())

        def compare(values: Any, part: dict[str, Any], where: str) -> None:
            if "$ref" in part:
                part = schema["definitions"][part["$ref"].rpartition("/")[2]]
            if not isinstance(values, dict) or where.endswith(".settings") or part.get("additionalProperties") is not False:
                return
            self.assertEqual(set(part["properties"]) - {"global", "claims"}, set(values), where)
            for name, value in values.items():
                compare(value, part["properties"][name], f"{where}.{name}")

        values = helm_chart.defaults()
        values["gateway"]["resources"]["limits"]["cpu"] = "1"
        compare(values, schema, "")

    # Kubernetes

    def test_kubernetes_knows_every_field(self) -> None:
        folder = folder_of(self)
        for name, outcome in self.rendered.items():
            (folder / f"{name}.yaml").write_text(outcome.text)
        result = kubeconform(*folder.glob("*.yaml"), *(CHART / "examples").glob("envoy-*.yaml"))
        self.assertEqual(result["resources"], [])
        summary = result["summary"]
        count = sum(len(objects) for objects in self.objects.values())
        self.assertEqual((summary["invalid"], summary["errors"], summary["skipped"]), (0, 0, 0))
        self.assertGreater(summary["valid"], count)  # and the example's

    def test_unknown_fields_would_be_found(self) -> None:
        spoilt: dict[str, tuple[str, Callable[[Object], object]]] = {
            "unknown": ("StatefulSet", lambda it: container(it).setdefault("env", []).append({"name": "A", "vlaue": "1"})),
            "type": ("Deployment", lambda it: it["spec"].update(replicas="three")),
            "missing": ("HorizontalPodAutoscaler", lambda it: it["spec"].pop("maxReplicas")),
            "null": ("Service", lambda it: it["spec"].update(selector=None)),
            "custom": ("ServiceMonitor", lambda it: it["spec"]["endpoints"][0].update(intervall="1s")),
            "version": ("PodDisruptionBudget", lambda it: it.update(apiVersion="policy/v1beta1")),
        }
        folder = folder_of(self)
        for name, (kind, spoil) in spoilt.items():
            thing = copy.deepcopy(next(it for objects in self.objects.values() for it in objects if it["kind"] == kind))
            (folder / f"{name}-good.yaml").write_text(yaml.safe_dump(thing))
            spoil(thing)
            (folder / f"{name}-bad.yaml").write_text(yaml.safe_dump(thing))
        found = {pathlib.Path(each["filename"]).name for each in kubeconform(*folder.glob("*.yaml"))["resources"]}
        self.assertEqual(found, {f"{name}-bad.yaml" for name in spoilt})

    def test_names_lead_somewhere(self) -> None:
        for objects in self.objects.values():
            names = [(thing["kind"], thing["metadata"]["name"]) for thing in objects]
            self.assertEqual(len(set(names)), len(names))
            pods = [work["spec"]["template"]["metadata"]["labels"] for work in workloads(objects)]
            for work in workloads(objects):
                self.check_workload(work, names)
            for thing in objects:
                spec = thing.get("spec", {})
                if thing["kind"] == "Service":
                    self.assertEqual(len(matching(spec["selector"], pods)), 1, thing["metadata"]["name"])
                    ports = {port["name"]: port["containerPort"] for port in container(chosen(objects, spec["selector"]))["ports"]}
                    for port in spec["ports"]:
                        self.assertEqual(ports[port["targetPort"]], port["port"])
                if thing["kind"] == "PodDisruptionBudget":
                    self.assertEqual(len(matching(spec["selector"]["matchLabels"], pods)), 1)
                if thing["kind"] == "NetworkPolicy":
                    self.check_policy(thing, objects)
                if thing["kind"] == "HorizontalPodAutoscaler":
                    target = spec["scaleTargetRef"]
                    self.assertIn((target["kind"], target["name"]), names)
                    self.assertNotIn("replicas", find(objects, "StatefulSet")["spec"])
                if thing["kind"] == "ServiceMonitor":
                    services = [it for it in objects if it["kind"] == "Service"]
                    (service,) = matching(spec["selector"]["matchLabels"], [it["metadata"]["labels"] for it in services])
                    ports = next(it for it in services if it["metadata"]["labels"] == service)["spec"]["ports"]
                    self.assertIn(spec["endpoints"][0]["port"], [port["name"] for port in ports])

    def check_workload(self, work: Object, names: list[tuple[str, str]]) -> None:
        template = work["spec"]["template"]
        pod = template["spec"]
        only = container(work)
        self.assertEqual(len(matching(work["spec"]["selector"]["matchLabels"], [template["metadata"]["labels"]])), 1)
        if work["kind"] == "StatefulSet":
            self.assertIn(("Service", work["spec"]["serviceName"]), names)
        volumes = {volume["name"] for volume in pod["volumes"]}
        volumes |= {claim["metadata"]["name"] for claim in work["spec"].get("volumeClaimTemplates", [])}
        self.assertEqual(volumes, {mount["name"] for mount in only["volumeMounts"]})
        ports = {port["name"] for port in only["ports"]}
        for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
            how = only[probe].get("httpGet") or only[probe]["tcpSocket"]
            self.assertEqual(how["port"], "admin")
            self.assertIn("admin", ports)
        for constraint in pod.get("topologySpreadConstraints", []):
            self.assertEqual(constraint["labelSelector"]["matchLabels"], work["spec"]["selector"]["matchLabels"])

    def check_policy(self, policy: Object, objects: list[Object]) -> None:
        spec = policy["spec"]
        self.assertEqual(spec["policyTypes"], ["Ingress", "Egress"])
        target = chosen(objects, spec["podSelector"]["matchLabels"])
        ports = {port["name"] for port in container(target)["ports"]}
        for rule in spec["ingress"]:
            self.assertLessEqual({port["port"] for port in rule["ports"]}, ports)
            for peer in rule.get("from", []):
                if "podSelector" in peer and "namespaceSelector" not in peer:
                    chosen(objects, peer["podSelector"]["matchLabels"])
        if target["kind"] == "StatefulSet":
            url = environment(target).get("CURVECAST_STORE", "")
            self.assertEqual(bool(spec["egress"]), url.startswith("s3://"))
            for rule in spec["egress"]:
                self.assertTrue(rule["ports"], "not everywhere")
        else:
            self.assertEqual(chosen(objects, spec["egress"][0]["to"][0]["podSelector"]["matchLabels"])["kind"], "StatefulSet")

    def test_pods_may_do_nothing_that_they_need_not(self) -> None:
        """Kubernetes' Pod Security Standard "restricted", and more."""
        for objects in self.objects.values():
            for work in workloads(objects):
                pod = work["spec"]["template"]["spec"]
                self.assertIs(pod["automountServiceAccountToken"], False)
                self.assertIs(pod["enableServiceLinks"], False)
                context = pod["securityContext"]
                self.assertEqual((context["runAsNonRoot"], context["runAsUser"], context["fsGroup"]), (True, 65532, 65532))
                self.assertEqual(context["seccompProfile"], {"type": "RuntimeDefault"})
                self.assertEqual(
                    container(work)["securityContext"],
                    {"allowPrivilegeEscalation": False, "readOnlyRootFilesystem": True, "capabilities": {"drop": ["ALL"]}},
                )
                self.assertFalse(any("hostPath" in volume for volume in pod["volumes"]))

    def test_pods_get_the_time_that_they_need_to_end(self) -> None:
        for objects in self.objects.values():
            for work in workloads(objects):
                variables = environment(work)
                grace = work["spec"]["template"]["spec"]["terminationGracePeriodSeconds"]
                if work["kind"] == "StatefulSet":
                    took = sum(int(variables[f"CURVECAST_{name}"]) for name in ("LAME_DUCK", "DRAIN", "MAX_STOP_TIME"))
                else:
                    took = 5 + int(variables["EDGE_STOP"].removesuffix("s"))
                    self.assertEqual(container(work)["lifecycle"]["preStop"]["exec"]["command"], ["sleep", "5"])
                self.assertEqual(grace, took + 10)

    # What is shared with others

    def test_files_are_those_of_deploy(self) -> None:
        objects = self.objects["everything"]
        deploy = SOURCE / "deploy"
        rules = find(objects, "PrometheusRule")
        self.assertEqual(rules["spec"], yaml.safe_load((deploy / "monitoring/rules.yml").read_text()))
        board = find(objects, "ConfigMap", "curvecast-sampler-dashboard")["data"]["curvecast.json"]
        self.assertEqual(json.loads(board), json.loads((deploy / "monitoring/dashboard.json").read_text()))
        config = find(objects, "ConfigMap", "curvecast-sampler-gateway")["data"]["haproxy.cfg"]
        self.assertEqual(config.strip(), (deploy / "haproxy/haproxy.cfg").read_text().strip())

    def test_a_package_of_the_chart_makes_the_same(self) -> None:
        folder = folder_of(self)
        outcome = helm_chart.helm("package", str(CHART), "--destination", str(folder))
        self.assertEqual(outcome.status, 0, outcome.errors)
        (package,) = folder.glob("*.tgz")
        command = ("template", "curvecast", str(package), "--namespace", NAMESPACE, "--kube-version", helm_chart.KUBERNETES)
        outcome = helm_chart.helm(*command, "--values", str(helm_chart.OPTIONS / "everything.yaml"))
        self.assertEqual(outcome.objects(), self.objects["everything"])

    def test_versions_are_those_of_the_project(self) -> None:
        chart = yaml.safe_load((CHART / "Chart.yaml").read_text())
        (version,) = re.findall(r"project\(curvecast\s+VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())
        self.assertEqual((chart["version"], chart["appVersion"]), (version, version))


def matching(selector: dict[str, str], labels: list[dict[str, str]]) -> list[dict[str, str]]:
    return [each for each in labels if selector.items() <= each.items()]


def chosen(objects: list[Object], selector: dict[str, str]) -> Object:
    """The only one whose pods `selector` means."""
    (work,) = [it for it in workloads(objects) if selector.items() <= it["spec"]["template"]["metadata"]["labels"].items()]
    return work


if __name__ == "__main__":
    unittest.main()
