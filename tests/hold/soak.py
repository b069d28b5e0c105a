"""200 streams on 20 sessions for ten minutes, with uploads, creates, closes and renders between: no error, nothing is left behind.

Every frame is compared, by its digest, with what a calm server answers to the same view. A quick run has 60 streams for one minute.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import statistics
import threading
import time
from collections.abc import AsyncIterator, Callable

from grpc import aio

from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import NOBODY, Caller, mesh_id_of
from hold.history import now
from hold.load import Load, StreamOfViews, heartbeat, open_aio
from hold.report import Report, quantile
from hold.servers import Server, Setting, Usage, eventually
from hold.shapes import bumpy_ball, orbit_view, plain_view

POINTS = (1000, 4000, 4000, 4000, 4000, 8000)  # of a stream's views, one stream after the other
STEP = 5  # degrees from view to view
RINGS, SESSION_POINTS = 24, 8000
INTERVAL = 1.0  # seconds between views of a stream
STREAMS_ON_ONE = 20  # streams that share a connection
MESH_LIMIT = 8 << 20  # bytes: what visitors upload is evicted
VISIT_PAUSE = 0.2  # seconds
CALM = ("--max-curve-vertices", "0")
P99_SECONDS = 0.1
WARM_SECONDS = 6
GRPC_POOLS = ("default-executo", "event_engine", "grpc_global_tim")  # threads that gRPC makes as it likes, a few for each core


def view_of(points: int, number: int) -> v1.SampleRequest:
    return orbit_view(points, STEP * number % 360)


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    streams, sessions = setting.pick(200, 60), setting.pick(20, 3)
    seconds = setting.pick(full=600, quick=60, hour=3600)
    meshes = [bumpy_ball(RINGS, seed) for seed in range(sessions)]
    ids = make_references(setting, meshes)
    cache = setting.folder / "cache"
    options = (*CALM, "--max-meshes", str(MESH_LIMIT))
    with Server(setting, "soaked", *options, cache=cache, mesh_limit=MESH_LIMIT) as server:
        with Caller(server, setting.history, "maker") as maker:
            for mesh in meshes:
                maker.upload("ball.off", mesh)
                maker.create(mesh_id_of(mesh), SESSION_POINTS)
        asyncio.run(ask_all(Load(setting.history), server, ids, [max(POINTS)]))  # ranks that views lack are made once
        put_under_load(setting, server, ids, streams, WARM_SECONDS)  # threads and buffers that stay
        at_rest = settle(server)
        begin = now()
        load, resident = put_under_load(setting, server, ids, streams, seconds)
        tell(report, load, begin, seconds, resident)
        tell_rest(report, server, at_rest, settle(server), streams)
    return report


def put_under_load(
    setting: Setting, server: Server, sessions: list[str], streams: int, seconds: int
) -> tuple[Load, list[tuple[float, int]]]:
    """Has streams, and visitors beside them. Returns what they saw, and when how many bytes were resident."""
    load, resident, over = Load(setting.history), [(now(), server.usage().resident)], threading.Event()
    threads = [threading.Thread(target=visit, args=(setting, server, n, over), daemon=True) for n in range(2)]
    threads.append(threading.Thread(target=watch, args=(server, over, resident), daemon=True))
    for thread in threads:
        thread.start()
    try:
        asyncio.run(soak(load, server, sessions, streams, now() + seconds))
    finally:
        over.set()
        for thread in threads:
            thread.join()
    return load, resident


def make_references(setting: Setting, meshes: list[bytes]) -> list[str]:
    """Has a calm server answer every view that will be asked for. Returns the sessions' ids."""
    with Server(setting, "calm", *CALM, reference=True) as server, Caller(server, setting.history, "reference") as caller:
        ids = []
        for mesh in meshes:
            caller.upload("ball.off", mesh)
            ids.append(caller.create(mesh_id_of(mesh), SESSION_POINTS).value.session_id)
        asyncio.run(ask_all(Load(setting.history), server, ids, sorted(set(POINTS))))
    return ids


async def ask_all(load: Load, server: Server, sessions: list[str], sizes: list[int]) -> None:
    """Asks for every view of so many points of all sessions, one after the other."""
    async with open_aio(server) as channel:
        for session in sessions:
            stream = StreamOfViews(load, server, channel, session, "reference", NOBODY)
            await stream.ask(every_view(sizes))
    if load.errors:
        raise RuntimeError(f"the server refuses without any load: {load.errors[0]}")


async def every_view(sizes: list[int]) -> AsyncIterator[v1.SampleRequest]:
    for points in sizes:
        for number in range(360 // STEP):
            yield view_of(points, number)


async def soak(load: Load, server: Server, sessions: list[str], streams: int, until: float) -> None:
    pulse = asyncio.create_task(heartbeat(load))
    async with contextlib.AsyncExitStack() as stack:
        channels = [await stack.enter_async_context(open_aio(server)) for _ in range(-(-streams // STREAMS_ON_ONE))]
        await asyncio.gather(*(one(load, server, channels[n // STREAMS_ON_ONE], sessions, n, until) for n in range(streams)))
    pulse.cancel()


async def one(load: Load, server: Server, channel: aio.Channel, sessions: list[str], number: int, until: float) -> None:
    points, start = POINTS[number % len(POINTS)], 7 * number
    next_view: Callable[[int], v1.SampleRequest] = lambda sequence: view_of(points, start + sequence)  # noqa: E731
    stream = StreamOfViews(load, server, channel, sessions[number % len(sessions)], f"stream {number}", NOBODY)
    await stream.run(next_view, INTERVAL, lambda: now() >= until, offset=INTERVAL * (number * 0.618 % 1))


def visit(setting: Setting, server: Server, number: int, over: threading.Event) -> None:
    """Brings a mesh, makes a session, looks at it and closes it, again and again."""
    with Caller(server, setting.history, f"visitor {number}") as caller:
        for visit_number in itertools.count():
            if over.wait(VISIT_PAUSE):
                return
            mesh = bumpy_ball(8) + b"# visit %d of %d\n" % (visit_number, number)
            if not caller.upload("visit.off", mesh).is_ok:
                continue
            created = caller.create(mesh_id_of(mesh), 500)
            if not created.is_ok:
                continue
            session = created.value.session_id
            caller.sample(session, plain_view(300))
            caller.call("Render", v1.RenderRequest(session_id=session, width=160, height=120), session=session)
            caller.call("ListSessions", v1.ListSessionsRequest())
            caller.end_session(session)


def watch(server: Server, over: threading.Event, resident: list[tuple[float, int]]) -> None:
    while not over.wait(1.0) and server.is_alive():
        resident.append((now(), server.usage().resident))


def settle(server: Server) -> Usage:
    """What the server takes when nobody is connected any more."""
    usage = server.usage()
    for _ in eventually(10):
        if server.metrics().get("curvecast_connections", 0) == 0:
            break
    time.sleep(1)
    for _ in eventually(10):
        before, usage = usage, server.usage()
        if before[1:] == usage[1:]:
            break
    return usage


def tell(report: Report, load: Load, begin: float, seconds: int, resident: list[tuple[float, int]]) -> None:
    times = load.between(begin, begin + seconds)
    report.figure("views", load.views)
    report.figure("ms median", 1000 * quantile(times, 0.5))
    late = quantile(load.lateness, 0.99)
    report.figure("ms p99 of views", 1000 * quantile(times, 0.99))
    report.figure("ms late, p99, of the client's own loop", 1000 * late)
    report.require("ms p99 less that", 1000 * (quantile(times, 0.99) - late), at_most=1000 * P99_SECONDS, timed=True)
    report.require("errors of streams", len(load.errors), at_most=0)
    report.notes += load.errors[:5]
    early, tenth = min(120, seconds // 2), max(10, seconds // 20)
    first = [size for at, size in resident if early <= at - begin < early + tenth]
    last = [size for at, size in resident if at - begin >= seconds - tenth]
    drift = 100 * (statistics.median(last) / statistics.median(first) - 1)
    report.figure("MB resident at the end", statistics.median(last) / 1e6)
    report.require("% drift of resident memory", drift, at_most=(report.is_quick and 10) or 2)


def tell_rest(report: Report, server: Server, before: Usage, after: Usage, streams: int) -> None:
    metrics = server.metrics()
    report.require("descriptors more than before", after.descriptors - before.descriptors, at_most=0)
    more = after.threads - before.threads
    for name in GRPC_POOLS:
        more.pop(name, None)
    report.figure("more threads", dict(more))
    # oneTBB makes its own, fewer than there are cores, when they are first wanted; a leak would be one a visit.
    report.require("threads more than before", more.total(), at_most=len(os.sched_getaffinity(0)) - 1)
    report.require("streams open", metrics["curvecast_open_streams"], at_most=0)
    report.require("bytes queued", metrics["curvecast_queued_bytes"], at_most=0)
    report.figure("streams", streams)
