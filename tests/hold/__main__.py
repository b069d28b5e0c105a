"""The command: deploy/test-hold has its help."""

from __future__ import annotations

import argparse
import ast
import collections
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

SCENARIOS = ("soak", "stalled", "memory", "descriptors", "kills", "corruption", "disk-full", "authorisation", "hostile")


def module_of(name: str) -> str:
    return name.replace("-", "_")


def first_line(name: str) -> str:
    """What a scenario says that it is. Read, not imported: the client need not be built."""
    source = pathlib.Path(__file__).with_name(f"{module_of(name)}.py").read_text()
    return (ast.get_docstring(ast.parse(source)) or "").splitlines()[0]


def run_scenario(name: str, setting: Setting) -> Report:
    """Runs one, and has its history checked."""
    try:
        report: Report = importlib.import_module(f"hold.{module_of(name)}").run(setting)
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


def run_all(options: argparse.Namespace, folder: pathlib.Path) -> dict[str, Any]:
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
        report = run_scenario(name, setting)
        seconds = time.monotonic() - begin
        results[name] = {"seconds": round(seconds, 1), **report.to_json()}
        print(f"{name:<14}{seconds:>5.0f} s  {results[name]['result']:<8} {report.line()}", flush=True)
        for fault in report.faults():
            print(f"{'':<23}FAILS: {fault}", flush=True)
        for note in report.notes[:5]:
            print(f"{'':<23}{note}", flush=True)
    return results


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="test-hold", usage="see deploy/test-hold --help", add_help=False)
    parser.add_argument("--command", required=True)
    parser.add_argument("--json")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--hour", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(SCENARIOS))
    parser.add_argument("--keep")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args(arguments)
    for name in options.only:
        if name not in SCENARIOS:
            parser.error(f"there is no scenario {name!r}: {', '.join(SCENARIOS)}")
    if options.quick and options.hour:
        parser.error("--quick and --hour exclude each other")
    return options


def stop(number: int, _: FrameType | None) -> None:
    raise SystemExit(128 + number)


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    if options.list:
        for name in SCENARIOS:
            print(f"{name:<14} {first_line(name)}")
        return 0
    signal.signal(signal.SIGTERM, stop)
    folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="curvecast-hold-")).absolute()
    is_kept = options.keep is not None
    begin = time.monotonic()
    try:
        results = run_all(options, folder)
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
        print(f"test-hold: {counts} in {time.monotonic() - begin:.0f} s, seed {options.seed}")
        if failed:
            print(f"test-hold: failed: {', '.join(failed)}; histories, logs and caches are in {folder}")
        return 1 if failed else 0
    except KeyboardInterrupt:
        print("test-hold: interrupted", file=sys.stderr)
        return 130
    finally:
        if not is_kept:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
