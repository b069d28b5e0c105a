"""kill -9 at any moment of uploads, preprocessing, saving, loading, closing and starting: nothing that was acknowledged is lost.

Every round starts a server on the same cache, asks for all that is known to be there, begins something and kills it.
"""

from __future__ import annotations

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
LOOKS = 30  # meshes that each round looks for
PHASES = ("upload", "create", "load", "close", "start")


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
    rounds = setting.pick(full=300, quick=20)
    sessions = [Wanted(seed, rings, points) for seed, (rings, points) in enumerate(SIZES)]
    with Server(setting, "calm", *CALM, reference=True) as calm, Caller(calm, setting.history, "reference") as caller:
        begin = time.monotonic()
        for wanted in sessions:
            caller.upload("ball.off", wanted.data)
            wanted.session = caller.create(wanted.mesh, wanted.points).value.session_id
            caller.sample(wanted.session, wanted.view)
        window = time.monotonic() - begin  # in which all of them are made
    keeps = keeps_uploads(setting)
    report.figure("uploads outlive restarts", keeps)
    cache = setting.folder / "cache"
    killed: dict[str, int] = dict.fromkeys(PHASES, 0)
    kept = left_over = lost = 0
    acknowledged: set[str] = set()
    for number in range(rounds):
        chance = random.Random(f"{setting.random.random()}")
        phase = PHASES[number % len(PHASES)]
        if phase == "start":
            server = Server(setting, "victim", *CALM, cache=cache, ready=False)
            time.sleep(0.1 * chance.random())
            server.kill()
            server.__exit__(None, None, None)
            killed[phase] += 1
            continue
        with Server(setting, "victim", *CALM, cache=cache, keeps_uploads=keeps) as server:
            left_over += len(temporaries(cache))
            with Caller(server, setting.history, f"round {number}", patience=60) as caller:
                kept += sum(caller.sample(wanted.session, wanted.view).is_ok for wanted in sessions)
                lost += sum(
                    not caller.get_mesh(mesh).is_ok for mesh in chance.sample(sorted(acknowledged), min(LOOKS, len(acknowledged)))
                )
                busy = threading.Event()
                thread = threading.Thread(target=work, args=(caller, sessions, phase, chance, acknowledged, busy))
                thread.start()
                busy.wait()
                time.sleep(chance.random() * window * (1.0 if phase == "create" else 0.2))
                server.kill()
                thread.join()
                killed[phase] += 1
        if not keeps:
            acknowledged.clear()  # that they are lost is what the last check is about
    with Server(setting, "victim", *CALM, cache=cache, keeps_uploads=keeps) as server:
        left_over += len(temporaries(cache))
        with Caller(server, setting.history, "last", patience=60) as caller:
            for wanted in sessions:
                caller.sample(wanted.session, wanted.view)  # the history says whether it has to be there
                caller.upload("ball.off", wanted.data)
                caller.create(wanted.mesh, wanted.points)
                caller.sample(wanted.session, wanted.view)
    report.figure("kills", sum(killed.values()))
    report.figure("kills by phase", killed)
    report.require("temporaries after a start", left_over, at_most=0)
    report.require("acknowledged uploads lost", lost, at_most=0)
    report.require("sessions served after kills", kept, at_least=rounds // 2)
    if not keeps:
        pending = "servers do not keep uploads over restarts yet"
        report.require("meshes lost by every restart", 1, at_most=0, pending=pending)
    return report


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
