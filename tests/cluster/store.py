"""Servers with a cache each and a store that they share: what only the store has is soon there, and while it is away what is here
goes on."""

from __future__ import annotations

import os
import pathlib
import threading
import time
from collections.abc import Iterator

from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import Caller, mesh_id_of
from hold.history import now
from hold.kills import CALM
from hold.report import Report, quantile
from hold.servers import Server, Setting, eventually
from hold.shapes import bumpy_ball, orbit_view

IGEA = "../shared/meshes/igea.ply"
RINGS, QUICK_RINGS = 260, 24  # of a ball with as many triangles as Igea has
POINTS, VIEW_POINTS = 65_536, 20_000
FIRST_FRAME = 0.3  # seconds
FRAME_SECONDS = 60.0  # that a frame may take at all
BACK_SECONDS = 60.0  # until what waited is put


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    store = setting.folder / "store"
    store.mkdir()
    name, mesh = great_mesh(setting)
    cache = setting.folder / "maker-cache"
    with (
        Server(setting, "maker", *options(store), cache=cache, store=str(store)) as server,
        Caller(server, setting.history, "maker") as caller,
    ):
        caller.upload(name, mesh)
        session = caller.create(mesh_id_of(mesh), POINTS).value.session_id
        stored = caller.wait_until_cached([session])
        look_at_first_frames(setting, report, store, session)
        look_while_it_is_away(setting, report, store, caller, session, mesh_id_of(mesh))
    report.require("sessions in the store", stored, at_least=1)
    return report


def options(store: pathlib.Path) -> tuple[str, ...]:
    return (*CALM, "--store", f"file://{store}")


def great_mesh(setting: Setting) -> tuple[str, bytes]:
    igea = pathlib.Path(os.environ["CURVECAST_SOURCE"], IGEA)
    if igea.is_file() and not setting.is_quick:
        return igea.name, igea.read_bytes()
    return "ball.off", bumpy_ball(setting.pick(full=RINGS, quick=QUICK_RINGS))


def look_at_first_frames(setting: Setting, report: Report, store: pathlib.Path, session: str) -> None:
    seconds, made = [], 0.0
    for number in range(setting.pick(full=10, quick=2)):
        cache = setting.folder / f"cache-{number}"
        with Server(setting, f"empty {number}", *options(store), cache=cache, store=str(store)) as server:
            with Caller(server, setting.history, "looker") as caller:
                seconds.append(first_frame(caller, session))
            made += server.metrics().get("curvecast_preprocess_seconds_count", 0)
    report.figure("first frames from an empty cache", len(seconds))
    report.figure("s median from opening a stream to its first frame", quantile(seconds, 0.5))
    report.require("sessions made again", made, at_most=0)
    report.require("s from opening a stream to its first frame, longest", max(seconds), at_most=FIRST_FRAME, timed=True)


def first_frame(caller: Caller, session: str) -> float:
    """From the first word of a stream to its first points, seconds."""
    over = threading.Event()

    def requests() -> Iterator[v1.StreamViewsRequest]:
        yield v1.StreamViewsRequest(open=v1.OpenView(session_id=session))
        yield v1.StreamViewsRequest(view=v1.ViewUpdate(sequence=1, sample=orbit_view(VIEW_POINTS, 0)))
        over.wait(FRAME_SECONDS)

    begin = now()
    try:
        for response in caller.stub.StreamViews(requests(), timeout=FRAME_SECONDS):
            if response.frame.HasField("error"):
                raise RuntimeError(response.frame.error.message)
            if response.frame.points:
                return now() - begin
    finally:
        over.set()
    raise RuntimeError("the stream ended without a frame")


def look_while_it_is_away(setting: Setting, report: Report, store: pathlib.Path, caller: Caller, session: str, mesh: str) -> None:
    """`caller`: of a server that has the session in memory."""
    away = store.with_name("elsewhere")
    failed = looks = 0
    store.rename(away)
    try:
        end = time.monotonic() + setting.pick(full=60, quick=3)
        begin = now()
        refused = caller.upload("other.off", bumpy_ball(6))
        setting.history.tell("fault", server=caller.server.name, begin=begin, end=now())
        later = caller.create(mesh, 1000)
        while time.monotonic() < end:
            looks += 1
            failed += not caller.sample(session, orbit_view(1000, 10.0 * looks)).is_ok
            time.sleep(0.1)
    finally:
        away.rename(store)
    report.figure("looks while the store was away", looks)
    report.require("looks that failed", failed, at_most=0)
    report.require("uploads refused with a reason", int(refused.code == "UNAVAILABLE" and "store" in refused.message), at_least=1)
    report.require("sessions made meanwhile", int(later.is_ok), at_least=1)
    put = any(caller.is_cached(later.value.session_id) for _ in eventually(BACK_SECONDS))
    report.require("of these in the store afterwards", int(put), at_least=1)
