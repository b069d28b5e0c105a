"""A cache whose disk is full: the server goes on, and saves what it could not save within 30 s after there is room.

The disk is a small one in memory, which takes root to mount.
"""

from __future__ import annotations

import contextlib
import pathlib
import subprocess
import time
from collections.abc import Iterator

from hold.calls import Caller, mesh_id_of
from hold.report import Report
from hold.servers import Server, Setting, temporaries
from hold.shapes import bumpy_ball, plain_view

CALM = ("--max-curve-vertices", "0")
DISK_BYTES, RINGS = 24 << 20, 12
SAVED_SECONDS = 30.0
SIZES = (300, 500, 700, 900, 1100)  # points of the sessions: the first is made while there is room


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    mesh, view = bumpy_ball(RINGS), plain_view(200)
    with contextlib.ExitStack() as stack:
        try:
            disk = stack.enter_context(mounted(setting.folder / "disk"))
        except (subprocess.CalledProcessError, OSError) as error:
            report.skipped = f"no disk can be mounted here: {error}"
            return report
        with Server(setting, "calm", *CALM, reference=True) as server, Caller(server, setting.history, "reference") as caller:
            caller.upload("ball.off", mesh)
            ids = [caller.create(mesh_id_of(mesh), points).value.session_id for points in SIZES]
            for session in ids:
                caller.sample(session, view)
        cache = disk / "cache"
        with Server(setting, "cramped", *CALM, cache=cache) as server, Caller(server, setting.history, "client") as caller:
            caller.upload("ball.off", mesh)
            caller.create(mesh_id_of(mesh), SIZES[0])
            caller.wait_until_cached(ids[:1])
            ballast = fill(disk)
            made = [caller.create(mesh_id_of(mesh), points) for points in SIZES[1:]]
            seen = [caller.sample(session, view) for session in ids]
            refused = caller.upload("large.off", bumpy_ball(60))
            saved_early = sum(caller.is_cached(session) for session in ids[1:])
            seen += [caller.sample(session, view) for session in ids]
            ballast.unlink()
            begin = time.monotonic()
            saved = caller.wait_until_cached(ids)
            seconds = time.monotonic() - begin
            left = temporaries(cache)
            uploaded = caller.upload("large.off", bumpy_ball(60))
            server.kill()
        with Server(setting, "cramped", *CALM, cache=cache) as server, Caller(server, setting.history, "after") as caller:
            after = [caller.sample(session, view) for session in ids]
    report.figure("upload to a full disk", refused.code)
    report.figure("message of it", refused.message)
    report.figure("sessions saved while it was full", saved_early)
    report.figure("sessions", len(ids))
    report.require("sessions refused while it was full", sum(not answer.is_ok for answer in made), at_most=0)
    report.require("views refused while it was full", sum(not answer.is_ok for answer in seen), at_most=0)
    report.require("uploads refused when there is room again", int(not uploaded.is_ok), at_most=0)
    report.require("temporaries left", len(left), at_most=0)
    report.require("sessions saved when there is room again", saved, at_least=len(ids))
    report.require("s until they were", seconds, at_most=SAVED_SECONDS)
    report.require("sessions lost by a kill after that", sum(not answer.is_ok for answer in after), at_most=0)
    return report


@contextlib.contextmanager
def mounted(folder: pathlib.Path) -> Iterator[pathlib.Path]:
    folder.mkdir()
    options = f"size={DISK_BYTES},mode=0700"
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], check=True, capture_output=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=False)


def fill(disk: pathlib.Path) -> pathlib.Path:
    """Takes all of the room that there is."""
    ballast = disk / "ballast"
    with open(ballast, "wb", buffering=0) as file, contextlib.suppress(OSError):
        while True:
            file.write(bytes(1 << 16))
    return ballast
