"""A quarter of the streams never reads, with the largest frames and with small ones: nobody else is refused, or waits for it.

The others' times are measured in turns: without those who do not read, and with them.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import itertools

from grpc import aio

from curvecast import View
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.calls import Caller, Who, key_of, mesh_id_of
from hold.history import now
from hold.load import Load, StreamOfViews, heartbeat, open_aio
from hold.report import Report, quantile
from hold.servers import Server, Setting, Target, eventually
from hold.shapes import bumpy_ball, orbit_view
from hold.warm_memory import warm_memory

CALM = ("--max-curve-vertices", "0")
LARGEST = (32 << 20) // 28  # points of which a frame of raw ones has MAX_FRAME_BYTES
SMALL = 2000
SESSION_POINTS, VIEW_POINTS, INTERVAL = 4000, 2000, 1.0
ON_ONE = 15  # streams that share a connection, of those who read
RATIO, FLOOR_SECONDS = 1.5, 0.01  # the client's own loop is late by as much
REST_SECONDS, LOOK = 60.0, 0.5
FULL_BYTES, FULL_SECONDS = 32e6, 120.0  # that are to wait for those who do not read; how long that may take
GROWTH = 64e6  # bytes
LAZY, BUSY = Who("lazy", "lazy's"), Who("busy", "busy's")


def run(setting: Setting) -> Report:
    with (
        Server(setting, "ignored", *CALM, *options(setting), tokens=True) as server,
        Caller(server, setting.history, "maker", BUSY) as maker,
    ):
        session = prepare(maker)
        base = server.unaccounted()
        report = measure(setting, server, session)
        report.require("MB grown beside what is held", server.growth(base, GROWTH) / 1e6, at_most=GROWTH / 1e6)
    return report


def options(setting: Setting) -> tuple[str, ...]:
    """Of a server: who may call, and less that may wait to be read than those who sleep would take. Half of that, and what all
    workers make at once, is less than all of it."""
    tokens = setting.folder / "tokens"
    tokens.write_text("".join(f"{who.name} {hashlib.sha256(who.token.encode()).hexdigest()}\n" for who in (LAZY, BUSY)))
    return "--max-queued", str(setting.pick(1 << 30, 256 << 20)), "--tokens", str(tokens)


def prepare(maker: Caller) -> str:
    """Makes the session that all look at."""
    mesh = bumpy_ball(24)
    maker.upload("ball.off", mesh)
    return str(maker.create(mesh_id_of(mesh), SESSION_POINTS).value.session_id)


def measure(setting: Setting, target: Target, session: str) -> Report:
    report = Report(setting.is_quick)
    warm_memory(report)
    readers, sleepers, seconds = setting.pick(150, 30), setting.pick(50, 10), setting.pick(20, 6)
    load, spans, most = asyncio.run(take_turns(setting, target, session, readers, sleepers, seconds))
    for _ in eventually(REST_SECONDS):
        metrics = target.metrics()
        if metrics["curvecast_queued_bytes"] == 0 and metrics["curvecast_open_streams"] == 0:
            break
    times = {kind: [took for span in turns for took in load.between(*span)] for kind, turns in spans.items()}
    calm = quantile(times["nobody"], 0.99)
    for kind, taken in times.items():
        report.figure(f"ms p99 of views beside {kind}", 1000 * quantile(taken, 0.99))
        report.figure(f"ms median beside {kind}", 1000 * quantile(taken, 0.5))
        if kind != "nobody":
            ratio = quantile(taken, 0.99) / max(calm, FLOOR_SECONDS)
            report.require(f"p99 of views beside {kind} over that without", ratio, at_most=RATIO, timed=True)
    report.figure("ms late, p99, of the client's own loop", 1000 * quantile(load.lateness, 0.99))
    report.figure("views", load.views)
    report.figure("streams that read", readers)
    report.figure("streams that do not", sleepers)
    report.figure("MB queued at most", most / 1e6)
    report.figure("calls ended for not reading", metrics["curvecast_stalled_calls_total"])
    report.require("views of others refused", load.refused, at_most=0)
    report.require("errors of others", len(load.errors), at_most=0)
    report.require("MB queued while they slept", most / 1e6, at_least=FULL_BYTES / 1e6)
    report.require("bytes queued at the end", metrics["curvecast_queued_bytes"], at_most=0)
    report.require("streams open at the end", metrics["curvecast_open_streams"], at_most=0)
    report.notes += load.errors[:5]
    return report


Spans = dict[str, list[tuple[float, float]]]


async def take_turns(
    setting: Setting, target: Target, session: str, readers: int, sleepers: int, seconds: int
) -> tuple[Load, Spans, float]:
    """Streams all the time, beside nobody, sleepers with the largest frames, nobody, and sleepers with small ones."""
    load, spans, most = Load(setting.history), Spans(), 0.0
    turns = (("nobody", 0), ("the largest frames", LARGEST), ("nobody", 0), ("small frames", SMALL))
    over = asyncio.Event()
    pulse = asyncio.create_task(heartbeat(load))
    async with contextlib.AsyncExitStack() as stack:
        channels = [await stack.enter_async_context(open_aio(target)) for _ in range(-(-readers // ON_ONE))]
        streams = asyncio.gather(*(read(load, target, channels[n // ON_ONE], session, n, over) for n in range(readers)))
        await asyncio.sleep(2 * INTERVAL)
        for kind, points in turns:
            begin = now()
            sleeping = [asyncio.create_task(sleep(target, session, points)) for _ in range(sleepers if points else 0)]
            while now() < begin + seconds or (points == LARGEST and most < FULL_BYTES and now() < begin + FULL_SECONDS):
                await asyncio.sleep(LOOK)
                metrics = await asyncio.to_thread(target.metrics)
                most = max(most, metrics["curvecast_queued_bytes"])
            spans.setdefault(kind, []).append((begin, now()))
            for task in sleeping:
                task.cancel()
            await asyncio.gather(*sleeping, return_exceptions=True)
        over.set()
        await streams
    pulse.cancel()
    return load, spans, most


async def read(load: Load, target: Target, channel: aio.Channel, session: str, number: int, over: asyncio.Event) -> None:
    stream = StreamOfViews(load, target, channel, session, f"reader {number}", BUSY)
    offset = INTERVAL * (number * 0.618 % 1)
    await stream.run(lambda sequence: orbit_view(VIEW_POINTS, 7 * number + 3 * sequence), INTERVAL, over.is_set, offset)


async def sleep(target: Target, session: str, points: int) -> None:
    """Asks for views on a connection of its own, and never reads one, until it is cancelled. What becomes of it does not matter."""
    async with open_aio(target) as channel:
        call = v1_grpc.CurvecastServiceStub(channel).StreamViews(metadata=(*LAZY.metadata, *key_of(session)))
        with contextlib.suppress(aio.AioRpcError, asyncio.InvalidStateError):
            await call.write(v1.StreamViewsRequest(open=v1.OpenView(session_id=session)))
            for sequence in itertools.count(1):
                view = View(points, sampler="equalised", seed=sequence).to_proto()
                await call.write(v1.StreamViewsRequest(view=v1.ViewUpdate(sequence=sequence, sample=view)))
                await asyncio.sleep(INTERVAL)
