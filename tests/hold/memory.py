"""A server in a control group of 512 MB, asked for up to 30 times as much: never killed, says what would fit, and views go on.

1,000 sessions of sizes from 1,000 points up to the API's limits, of which the greatest would take 23 GB, and three inspections of
meshes of 100 MB at once, beside one client that streams views. One in twenty has any size up to the limits, the others take seconds
together: each that is made costs the processors what its points cost, so 1,000 of all sizes would take an hour.
"""

from __future__ import annotations

import asyncio
import collections
import contextlib
import itertools
import math
import random
import re
import threading

from hold.calls import NOBODY, Answer, Caller, mesh_id_of
from hold.cgroups import memory_group
from hold.history import now
from hold.load import Load, StreamOfViews, heartbeat, open_aio
from hold.report import Report, quantile
from hold.servers import Server, Setting
from hold.shapes import TETRAHEDRON, bumpy_ball, orbit_view, relief_stl
from hold.warm_memory import warm_memory

LIMIT = 512 << 20
CREATORS, LEAST_POINTS, OMEGAS = 4, 1000, (1.0, 10.0, 25.0)
MOST_POINTS, MOST_OF_SMALL = 4_000_000, 2000
INSPECTIONS = 3
VIEWS_A_SECOND, VIEW_POINTS = 5, 2000
PATIENCE = 300.0  # of a create: one after the other is made
CALM_SECONDS, LONGEST_SECONDS, LOOK = 8.0, 400.0, 0.2
LEAST_VIEWS = 20  # before and meanwhile, however slow the machine is
RATIO, FLOOR_SECONDS = 3.0, 0.01  # the client's own loop is late by as much
QUANTITY = re.compile(r"\d[\d.,]* ?(?:[KMG]i?B|bytes)")


class Tally:
    def __init__(self, wanted: int) -> None:
        self.numbers = itertools.count()
        self.wanted = wanted
        self.creates: collections.Counter[str] = collections.Counter()  # by how they ended
        self.inspections: collections.Counter[str] = collections.Counter()
        self.silent: list[str] = []  # refusals that do not say what would fit
        self.largest = 0.0  # points times omega, made
        self.over = threading.Event()
        self.callers: list[Caller] = []

    def take(self, what: str, answer: Answer, ended: collections.Counter[str]) -> None:
        if self.over.is_set():
            return  # it was cancelled
        ended[answer.code] += 1
        if answer.code == "RESOURCE_EXHAUSTED" and len(QUANTITY.findall(answer.message)) < 2:
            self.silent.append(f"{what}: {answer.message}")


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    with contextlib.ExitStack() as stack:
        try:
            group = stack.enter_context(memory_group(LIMIT))
        except OSError as error:
            report.skipped = f"no control group can be made here: {error}"
            return report
        warm_memory(report)
        server = stack.enter_context(Server(setting, "bounded", cache=setting.folder / "cache", prefix=group.prefix))
        with Caller(server, setting.history, "maker") as maker:
            mesh = bumpy_ball(24)
            maker.upload("ball.off", mesh)
            session = maker.create(mesh_id_of(mesh), VIEW_POINTS).value.session_id
            maker.upload("tetrahedron.off", TETRAHEDRON)
        tally = Tally(setting.pick(full=1000, quick=40))
        reliefs = [relief_stl(setting.pick(full=100, quick=30), seed) for seed in range(INSPECTIONS)]
        load = Load(setting.history)
        seconds = setting.pick(full=300, quick=40)
        begin, until = asyncio.run(watch_views(setting, server, session, load, tally, reliefs, seconds))
        is_alive = server.is_alive()
        kills = group.kills()
        peak = group.peak()
        if is_alive:
            server.kill()  # what it still makes may take minutes
    calm, busy = (quantile(load.between(*span), 0.99) for span in ((0, begin), (begin, until)))
    report.figure("creates by outcome", dict(tally.creates))
    report.figure("inspections by outcome", dict(tally.inspections))
    report.figure("points times omega of the largest made", tally.largest)
    report.figure("MB at most, files too", peak / 1e6)
    report.figure("ms p99 of views before", 1000 * calm)
    report.figure("ms p99 of views meanwhile", 1000 * busy)
    report.figure("ms late, p99, of the client's own loop", 1000 * quantile(load.lateness, 0.99))
    report.figure("views before", len(load.between(0, begin)))
    report.require("views meanwhile", len(load.between(begin, until)), at_least=LEAST_VIEWS)
    report.require("kills", kills + (not is_alive), at_most=0)
    report.require("views that failed", len(load.errors), at_most=0)
    report.require("p99 of views meanwhile over that before", busy / max(calm, FLOOR_SECONDS), at_most=RATIO, timed=True)
    report.require("refusals that do not say what would fit", len(tally.silent), at_most=0)
    report.require("creates answered", tally.creates.total(), at_least=tally.wanted, timed=True)
    report.notes += [*load.errors[:3], *tally.silent[:3]]
    return report


async def watch_views(
    setting: Setting, server: Server, session: str, load: Load, tally: Tally, reliefs: list[bytes], seconds: int
) -> tuple[float, float]:
    """Streams views before and while others ask for too much. Returns when that began and ended."""
    pulse = asyncio.create_task(heartbeat(load))
    over = asyncio.Event()
    begin = now() + CALM_SECONDS
    async with open_aio(server) as channel:
        stream = StreamOfViews(load, server, channel, session, "viewer", NOBODY)
        viewer = asyncio.create_task(
            stream.run(lambda number: orbit_view(VIEW_POINTS, 3 * number), 1 / VIEWS_A_SECOND, over.is_set, offset=0)
        )
        while (now() < begin or load.views < LEAST_VIEWS) and not viewer.done():
            await asyncio.sleep(LOOK)
        begin = now()
        threads = [
            threading.Thread(target=create, args=(setting, server, tally, setting.random.random()), daemon=True)
            for _ in range(CREATORS)
        ]
        threads += [threading.Thread(target=inspect, args=(setting, server, tally, mesh), daemon=True) for mesh in reliefs]
        for thread in threads:
            thread.start()
        while server.process.poll() is None and now() < begin + LONGEST_SECONDS:
            is_done = now() >= begin + seconds or not any(thread.is_alive() for thread in threads)
            if is_done and len(load.between(begin, now())) >= LEAST_VIEWS:
                break
            await asyncio.sleep(LOOK)
        until = now()
        over.set()
        tally.over.set()
        for caller in tally.callers:
            caller.close()  # cancels what they still wait for
        viewer.cancel()
        pulse.cancel()
        for thread in threads:
            await asyncio.to_thread(thread.join)
    return begin, until


def create(setting: Setting, server: Server, tally: Tally, seed: float) -> None:
    """Asks for sessions of the tetrahedron, of all sizes."""
    chance = random.Random(seed)
    with Caller(server, setting.history, "creator") as caller:
        tally.callers.append(caller)
        for number in tally.numbers:
            if number >= tally.wanted or tally.over.is_set():
                break
            is_any = chance.random() < 1 / setting.pick(full=20, quick=2)
            most = MOST_POINTS if is_any else MOST_OF_SMALL
            points = int(LEAST_POINTS * math.exp(chance.random() * math.log(most / LEAST_POINTS)))
            omega = chance.choice(OMEGAS)
            answer = caller.create(mesh_id_of(TETRAHEDRON), points, omega=omega, seed=number, patience=PATIENCE)
            tally.take(f"{points} points, omega {omega}", answer, tally.creates)
            if answer.is_ok:
                tally.largest = max(tally.largest, points * omega)


def inspect(setting: Setting, server: Server, tally: Tally, mesh: bytes) -> None:
    with Caller(server, setting.history, "inspector") as caller:
        tally.callers.append(caller)
        uploaded = caller.upload("relief.stl", mesh)
        answer = caller.inspect(mesh_id_of(mesh), PATIENCE) if uploaded.is_ok else uploaded
        tally.take(f"inspection of {len(mesh)} bytes", answer, tally.inspections)
