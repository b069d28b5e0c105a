"""deploy/helm as the tests see it: values, and what Helm makes of them."""

from __future__ import annotations

import copy
import dataclasses
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest
from collections.abc import Iterator
from typing import Any, ClassVar

import yaml

SOURCE = pathlib.Path(os.environ.get("CURVECAST_SOURCE", pathlib.Path(__file__).parents[2]))
CHART = SOURCE / "deploy/helm"
OPTIONS = SOURCE / "tests/deploy/helm"
TOOLS = SOURCE / "build/tools"
#: The oldest one that the chart is for.
KUBERNETES = "1.27.0"
NAMESPACE = "scans"

Values = dict[str, Any]
Object = dict[str, Any]
Path = tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Outcome:
    status: int
    text: str
    errors: str

    def objects(self) -> list[Object]:
        return [document for document in yaml.load_all(self.text, yaml.CSafeLoader) if document]


def helm(*arguments: str, given: str | None = None) -> Outcome:
    done = subprocess.run([TOOLS / "helm", *arguments], input=given, capture_output=True, text=True, check=False)
    # It tells of every link; there is one for each file that the chart shares with others.
    errors = "".join(line for line in done.stderr.splitlines(keepends=True) if "found symbolic link in path" not in line)
    return Outcome(done.returncode, done.stdout, errors)


def template(values: Values) -> Outcome:
    """`values` as another -f, which is where `null` takes a default away."""
    command = ("template", "curvecast", str(CHART), "--namespace", NAMESPACE, "--kube-version", KUBERNETES, "--values", "-")
    return helm(*command, given=yaml.safe_dump(values))


def defaults() -> Values:
    return dict(yaml.safe_load((CHART / "values.yaml").read_text()))


def options() -> dict[str, Values]:
    """By the names of their files."""
    files = sorted(path for path in OPTIONS.glob("*.yaml") if path.stem != "refused")
    return {path.stem: yaml.safe_load(path.read_text()) for path in files}


def refused() -> list[dict[str, Any]]:
    return list(yaml.safe_load((OPTIONS / "refused.yaml").read_text()))


#: Values that are not the chart's own, but a whole of Kubernetes' or of the operator's.
WHOLE = {"affinity", "nodeSelector", "podLabels", "podAnnotations", "resources", "annotations", "labels", "dashboardLabels"}


def leaves(values: Values, above: Path = ()) -> Iterator[tuple[Path, Any]]:
    for name, value in values.items():
        if isinstance(value, dict) and name not in WHOLE:
            yield from leaves(value, (*above, name))
        else:
            yield (*above, name), value


def without(values: Values, path: Path) -> Values:
    """As if `path` had not been said."""
    result = copy.deepcopy(values)
    folder = result
    for name in path[:-1]:
        folder = folder[name]
    del folder[path[-1]]
    return result


def at(values: Values, path: Path) -> Any:
    """None where nothing is said of it."""
    result: Any = values
    for name in path:
        if not isinstance(result, dict) or name not in result:
            return None
        result = result[name]
    return result


def find(objects: list[Object], kind: str, name: str | None = None) -> Object:
    found = [thing for thing in objects if thing["kind"] == kind and name in (None, thing["metadata"]["name"])]
    if len(found) != 1:
        raise AssertionError(f"{len(found)} of {kind} {name}")
    return found[0]


def workloads(objects: list[Object]) -> list[Object]:
    return [thing for thing in objects if thing["kind"] in ("StatefulSet", "Deployment")]


def container(workload: Object) -> Object:
    (only,) = workload["spec"]["template"]["spec"]["containers"]
    return dict(only)


def environment(workload: Object) -> dict[str, str]:
    variables = container(workload)["env"]
    names = [variable["name"] for variable in variables]
    if len(set(names)) != len(names):
        raise AssertionError(f"a variable stands twice in {names}")
    return {variable["name"]: variable["value"] for variable in variables}


def eventually(seconds: float = 60) -> Iterator[None]:
    """Goes on until the loop ends, or the time has passed."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        yield
        time.sleep(0.05)
    raise AssertionError(f"not within {seconds} s")


def command_of(test: unittest.TestCase) -> str:
    command = os.environ.get("CURVECAST_COMMAND")
    if not command:
        test.skipTest("there is no built curvecast: CURVECAST_BUILD names the folder of a build")
    return command


def folder_of(test: unittest.TestCase) -> pathlib.Path:
    path = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-helm-"))
    test.addCleanup(shutil.rmtree, path)
    return path


class Rendered(unittest.TestCase):
    """What Helm makes of the chart with each file of options."""

    options: ClassVar[dict[str, Values]]
    rendered: ClassVar[dict[str, Outcome]]
    objects: ClassVar[dict[str, list[Object]]]

    @classmethod
    def setUpClass(cls) -> None:
        cls.options = options()
        cls.rendered = {name: template(values) for name, values in cls.options.items()}
        for name, outcome in cls.rendered.items():
            if outcome.status != 0:
                raise AssertionError(f"{name}: {outcome.errors}")
        cls.objects = {name: outcome.objects() for name, outcome in cls.rendered.items()}
