"""kill -9 at any moment of uploads, preprocessing, saving, loading, closing and starting: nothing that was acknowledged is lost.

Every round starts a server on the same cache, asks for all that is known to be there, begins something and kills it.
"""

from __future__ import annotations

import collections
import json
import pathlib
import random
import shutil
import threading
import time

from hold.calls import Answer, Caller, mesh_id_of
from hold.report import Report
from hold.servers import Server, Setting, temporaries
from hold.shapes import bumpy_ball, plain_view

SIZES = ((12, 500), (12, 3000), (24, 1000), (24, 5000), (48, 3000), (48, 8000))  # rings of the mesh, points of the session
UPLOAD_RINGS = 60  # of what is uploaded all the time: half a megabyte
CALM = ("--max-curve-vertices", "0")
START_SECONDS, PATIENCE = 0.1, 60.0
LOOKS = 30  # meshes that each round looks for
PHASES = ("upload", "create", "load", "close", "start")
REFILL = 2 * len(PHASES)  # rounds from one in which all sessions are made to the next: nine are served after that, at least


class Wanted:
    """A session that may be asked for."""

    def __init__(self, seed: int, rings: int, points: int) -> None:
        self.data = bumpy_ball(rings, seed)
        self.mesh = mesh_id_of(self.data)
        self.points = points
        self.session = ""  # once it was made
        self.view = plain_view(400, seed)


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    rounds = Rounds(setting)
    number = setting.pick(full=300, quick=20)
    for at in range(number):
        rounds.run_one(PHASES[at % len(PHASES)], f"round {at}", makes_all=at % REFILL == 0)
    rounds.look_at_last()
    report.figure("kills", rounds.killed.total())
    report.figure("kills by phase", dict(rounds.killed))
    report.figure("calls broken off", dict(broken_off(setting.history.path)))
    report.figure("uploads outlive restarts", rounds.keeps)
    report.require("temporaries after a start", rounds.left_over, at_most=0)
    report.require("acknowledged uploads lost", rounds.lost, at_most=0)
    report.require("sessions served after kills", rounds.kept, at_least=number // 2)
    report.require("meshes lost by every restart", int(not rounds.keeps), at_most=0)
    return report


class Rounds:
    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.cache = setting.folder / "cache"
        self.sessions = [Wanted(seed, rings, points) for seed, (rings, points) in enumerate(SIZES)]
        self.killed: collections.Counter[str] = collections.Counter()
        self.kept = self.left_over = self.lost = 0
        self.acknowledged: set[str] = set()  # meshes
        with Server(setting, "calm", *CALM, reference=True) as calm, Caller(calm, setting.history, "reference") as caller:
            begin = time.monotonic()
            for wanted in self.sessions:
                caller.upload("ball.off", wanted.data)
                wanted.session = caller.create(wanted.mesh, wanted.points).value.session_id
                caller.sample(wanted.session, wanted.view)
            self.window = time.monotonic() - begin  # seconds in which all of them are made
        self.keeps = keeps_uploads(setting)

    def start(self, ready: bool = True) -> Server:
        return Server(self.setting, "victim", *CALM, cache=self.cache, ready=ready, keeps_uploads=self.keeps)

    def run_one(self, phase: str, name: str, makes_all: bool) -> None:
        chance = random.Random(f"{self.setting.random.random()}")
        self.killed[phase] += 1
        if phase == "start":
            with self.start(ready=False) as server:
                time.sleep(START_SECONDS * chance.random())
                server.kill()
            return
        with self.start() as server, Caller(server, self.setting.history, name, patience=PATIENCE) as caller:
            self.left_over += len(temporaries(self.cache))
            if phase != "load":
                self.look(caller, chance)
            if makes_all:
                self.make_all(caller)
            busy = threading.Event()
            thread = threading.Thread(
                target=work, args=(caller, self.sessions, phase, chance, self.acknowledged, busy), daemon=True
            )
            thread.start()
            busy.wait()
            time.sleep(chance.random() * self.window * (1.0 if phase == "create" else 0.1))
            server.kill()
            thread.join()
        if not self.keeps:
            self.acknowledged.clear()  # that they are lost is what the last requirement is about

    def make_all(self, caller: Caller) -> None:
        """Once in a while, in a round of uploads: something to lose, however slow the machine."""
        for wanted in self.sessions:
            caller.upload("ball.off", wanted.data)
            caller.create(wanted.mesh, wanted.points)
        caller.wait_until_cached([wanted.session for wanted in self.sessions])

    def look(self, caller: Caller, chance: random.Random) -> None:
        """Asks for all that may be there; whether it has to, the history tells."""
        self.kept += sum(caller.sample(wanted.session, wanted.view).is_ok for wanted in self.sessions)
        some = chance.sample(sorted(self.acknowledged), min(LOOKS, len(self.acknowledged)))
        self.lost += sum(not caller.get_mesh(mesh).is_ok for mesh in some)

    def look_at_last(self) -> None:
        with self.start() as server, Caller(server, self.setting.history, "last", patience=PATIENCE) as caller:
            self.left_over += len(temporaries(self.cache))
            self.look(caller, self.setting.random)
            for wanted in self.sessions:
                caller.upload("ball.off", wanted.data)
                caller.create(wanted.mesh, wanted.points)
                caller.sample(wanted.session, wanted.view)


def broken_off(history: pathlib.Path) -> collections.Counter[str]:
    """Calls under way when a server was killed."""
    with history.open(encoding="utf-8") as lines:
        events = [json.loads(line) for line in lines if '"UNAVAILABLE"' in line and "failed to connect" not in line]
    return collections.Counter(event["call"] for event in events)


def keeps_uploads(setting: Setting) -> bool:
    """Tells whether a mesh is there after an orderly restart on the same folder: where it is, it has to outlive a kill too."""
    cache = setting.folder / "probe"
    data = bumpy_ball(8)
    with Server(setting, "probe", cache=cache) as server, Caller(server, setting.history, "probe") as caller:
        caller.upload("ball.off", data)
    with Server(setting, "probe", cache=cache) as server, Caller(server, setting.history, "probe") as caller:
        is_kept = caller.get_mesh(mesh_id_of(data)).is_ok
    shutil.rmtree(cache)
    return is_kept


def work(
    caller: Caller, sessions: list[Wanted], phase: str, chance: random.Random, acknowledged: set[str], busy: threading.Event
) -> None:
    """Does what is to be killed, until the server dies."""
    order = chance.sample(sessions, len(sessions))
    if phase == "upload":
        large = bumpy_ball(UPLOAD_RINGS)
        busy.set()
        for number in range(1000):
            data = large + b"# %d\n" % (chance.randrange(1 << 40) + number)
            if not is_there(caller.upload("large.off", data), acknowledged, mesh_id_of(data)):
                return
    if phase == "close":
        busy.set()
        for wanted in order:
            caller.end_session(wanted.session)
    if phase == "load":
        busy.set()
        while all(caller.sample(wanted.session, wanted.view).code in ("OK", "NOT_FOUND") for wanted in order):
            pass
        return
    for wanted in order[: len(order) // 2]:
        caller.end_session(wanted.session)
    busy.set()
    for wanted in order:
        if not is_there(caller.upload("ball.off", wanted.data), acknowledged, wanted.mesh):
            return
        caller.create(wanted.mesh, wanted.points)
        caller.sample(wanted.session, wanted.view)
    while all(caller.get(wanted.session).is_ok for wanted in order):  # until one is lost with its server: who is cached by then?
        time.sleep(0.002)


def is_there(answer: Answer, acknowledged: set[str], mesh: str) -> bool:
    if answer.is_ok:
        acknowledged.add(mesh)
    return answer.is_ok
