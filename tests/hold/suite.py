"""A command that runs scenarios: deploy/test-hold and deploy/test-cluster have their helps."""

from __future__ import annotations

import argparse
import ast
import collections
import dataclasses
import importlib
import json
import os
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from types import FrameType
from typing import Any

from hold import check_history
from hold.history import History
from hold.report import Report
from hold.servers import Setting


@dataclasses.dataclass(frozen=True)
class Suite:
    program: str  # below deploy/
    scenarios: tuple[str, ...]  # each a module of `folder`, with dashes
    folder: pathlib.Path  # of a package
    has_hours: bool = False

    def module_of(self, name: str) -> str:
        return name.replace("-", "_")

    def first_line(self, name: str) -> str:
        """What a scenario says that it is. Read, not imported: the client need not be built."""
        source = (self.folder / f"{self.module_of(name)}.py").read_text()
        return (ast.get_docstring(ast.parse(source)) or "").splitlines()[0]


def run_scenario(suite: Suite, name: str, setting: Setting) -> Report:
    """Runs one, and has its history checked."""
    try:
        report: Report = importlib.import_module(f"{suite.folder.name}.{suite.module_of(name)}").run(setting)
    except Exception as error:  # noqa: BLE001: the others go on
        report = Report(setting.is_quick)
        report.notes.append(f"{type(error).__name__}: {error}")
        report.require("scenarios broken off", 1, at_most=0)
        (setting.folder / "traceback.txt").write_text(traceback.format_exc())
    finally:
        setting.history.close()
    if not report.skipped:
        result = check_history.check_file(setting.history.path)
        report.figure("calls recorded", setting.history.calls)
        report.figure("judged", result.judged)
        report.require("answers against the model", len(result.violations), at_most=0)
        report.notes += [str(violation) for violation in result.violations[:20]]
    return report


def run_all(suite: Suite, options: argparse.Namespace, folder: pathlib.Path) -> dict[str, Any]:
    results: dict[str, Any] = {}
    for name in options.only:
        begin = time.monotonic()
        place = folder / name
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        setting = Setting(
            command=pathlib.Path(options.command),
            folder=place,
            history=History(place / "history.jsonl"),
            random=random.Random(f"{options.seed} {name}"),
            is_quick=options.quick,
            is_hour=options.hour,
        )
        report = run_scenario(suite, name, setting)
        seconds = time.monotonic() - begin
        results[name] = {"seconds": round(seconds, 1), **report.to_json()}
        print(f"{name:<14}{seconds:>5.0f} s  {results[name]['result']:<8} {report.line()}", flush=True)
        for fault in report.faults():
            print(f"{'':<23}FAILS: {fault}", flush=True)
        for note in report.notes[:5]:
            print(f"{'':<23}{note}", flush=True)
    return results


def parse(suite: Suite, arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog=suite.program, usage=f"see deploy/{suite.program} --help", add_help=False)
    parser.add_argument("--command", required=True)
    parser.add_argument("--json")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--hour", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(suite.scenarios))
    parser.add_argument("--keep")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args(arguments)
    for name in options.only:
        if name not in suite.scenarios:
            parser.error(f"there is no scenario {name!r}: {', '.join(suite.scenarios)}")
    if options.hour and not suite.has_hours:
        parser.error("there is no --hour")
    if options.quick and options.hour:
        parser.error("--quick and --hour exclude each other")
    return options


def stop(number: int, _: FrameType | None) -> None:
    raise SystemExit(128 + number)


def main(suite: Suite, arguments: list[str]) -> int:
    options = parse(suite, arguments)
    if options.list:
        for name in suite.scenarios:
            print(f"{name:<14} {suite.first_line(name)}")
        return 0
    signal.signal(signal.SIGTERM, stop)
    folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix=f"curvecast-{suite.program}-")).absolute()
    is_kept = options.keep is not None
    begin = time.monotonic()
    try:
        results = run_all(suite, options, folder)
        ended = collections.Counter(result["result"] for result in results.values())
        failed = [name for name, result in results.items() if result["result"] == "failed"]
        is_kept = is_kept or bool(failed)
        if options.json:
            told = {
                "cores": len(os.sched_getaffinity(0)),
                "seed": options.seed,
                "quick": options.quick,
                "seconds": round(time.monotonic() - begin, 1),
                "scenarios": results,
            }
            pathlib.Path(options.json).write_text(json.dumps(told, indent=2) + "\n")
        counts = ", ".join(f"{number} {how}" for how, number in ended.items())
        print(f"{suite.program}: {counts} in {time.monotonic() - begin:.0f} s, seed {options.seed}")
        if failed:
            print(f"{suite.program}: failed: {', '.join(failed)}; histories, logs and caches are in {folder}")
        return 1 if failed else 0
    except KeyboardInterrupt:
        print(f"{suite.program}: interrupted", file=sys.stderr)
        return 130
    finally:
        if not is_kept:
            shutil.rmtree(folder, ignore_errors=True)
