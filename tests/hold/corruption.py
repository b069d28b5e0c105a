"""Cache files with flipped bits, cut short, or another session's, between loads and during them: no wrong point, all made anew.

Every trial spoils one file. Between loads the server is down meanwhile; during loads it has room for half of the sessions, clients
ask for all of them all the time, and the spoilt file takes the place of the good one, as a disk's or a copy's mistake would.
"""

from __future__ import annotations

import collections
import os
import pathlib
import random
import shutil
import threading

from hold.calls import Caller, mesh_id_of
from hold.history import now
from hold.report import Report
from hold.servers import Server, Setting, eventually
from hold.shapes import bumpy_ball, plain_view

CALM = ("--max-curve-vertices", "0")
SESSIONS, RINGS, POINTS, SAMPLE = 8, 8, 300, 200
READERS, ROOM = 2, "4"  # sessions in memory: fewer than there are, and one for each who asks
PATIENCE = 60.0
FLIP, CUT, EXCHANGE = "flip", "truncation", "exchange"


class Spoilt:
    """The sessions, their files as they were, and what became of trials."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.chance = setting.random
        self.cache, self.good = setting.folder / "cache", setting.folder / "good"
        self.meshes = [bumpy_ball(RINGS, seed) for seed in range(SESSIONS)]
        self.views = [plain_view(SAMPLE, seed) for seed in range(SESSIONS)]
        self.ids: list[str] = []
        self.right: list[str] = []  # digests
        self.trials: collections.Counter[str] = collections.Counter()
        self.outcomes: collections.Counter[str] = collections.Counter()

    def start(self, *options: str) -> Server:
        return Server(self.setting, "spoilt", *CALM, *options, cache=self.cache)

    def caller(self, server: Server, name: str) -> Caller:
        return Caller(server, self.setting.history, name, patience=PATIENCE)

    def make(self) -> None:
        """Has a calm server tell what is right, and another one fill the cache."""
        with Server(self.setting, "calm", *CALM, reference=True) as server, self.caller(server, "reference") as caller:
            for number in range(SESSIONS):
                self.ids.append(self.create(caller, number))
                self.right.append(caller.sample(self.ids[number], self.views[number]).value)
        with self.start() as server, self.caller(server, "maker") as caller:
            self.restore(caller)
        shutil.copytree(self.cache, self.good)

    def create(self, caller: Caller, number: int) -> str:
        caller.upload("ball.off", self.meshes[number])
        answer = caller.create(mesh_id_of(self.meshes[number]), POINTS)
        return str(answer.value.session_id) if answer.is_ok else ""

    def restore(self, caller: Caller) -> None:
        """Has every session made that is not there, and waits until all are saved."""
        for number in range(SESSIONS):
            self.create(caller, number)
        for number in range(SESSIONS):
            for _ in eventually(PATIENCE):
                if caller.is_cached(self.ids[number]):
                    break

    def spoil(self, kind: str, number: int, in_place: bool) -> str:
        """Spoils a file of a session. Returns which."""
        path = self.chance.choice(sorted(self.cache.glob(f"{self.ids[number]}.*")))
        self.trials[kind] += 1
        if kind == EXCHANGE:
            other = self.chance.choice([n for n in range(SESSIONS) if n != number])
            partner = self.cache / path.name.replace(self.ids[number], self.ids[other])
            data = (self.good / partner.name).read_bytes()
        else:
            data = path.read_bytes()
            data = flipped(data, self.chance) if kind == FLIP else data[: self.chance.randrange(len(data))]
        self.setting.history.tell(
            "damage", store=str(self.cache), session=self.ids[number], at=now(), what=f"{kind} of {path.name}"
        )
        if in_place:
            path.write_bytes(data)
        else:
            beside = path.with_name("beside")
            beside.write_bytes(data)
            os.replace(beside, path)
        return path.suffix[1:]

    def look(self, caller: Caller, number: int) -> None:
        """Asks for the session by its id, then has it made where it is lost, and asks again."""
        answer = caller.sample(self.ids[number], self.views[number])
        self.outcomes[self.judge(answer.code, answer.value, number)] += 1
        is_right = False
        for _ in eventually(PATIENCE):  # others may push it out before it is saved
            self.create(caller, number)
            answer = caller.sample(self.ids[number], self.views[number])
            is_right = self.judge(answer.code, answer.value, number) == "right all the same"
            if is_right or answer.is_ok:
                break
        self.outcomes["made anew" if is_right else "not made anew"] += 1

    def judge(self, code: str, digest: str, number: int) -> str:
        if code == "OK":
            return "right all the same" if digest == self.right[number] else "wrong points"
        return "detected" if code == "NOT_FOUND" else f"refused: {code}"


def flipped(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    wanted = {FLIP: setting.pick(1000, 100), CUT: setting.pick(200, 20), EXCHANGE: setting.pick(50, 5)}
    kinds = [kind for kind, number in wanted.items() for _ in range(number)]
    setting.random.shuffle(kinds)
    spoilt = Spoilt(setting)
    spoilt.make()
    half = len(kinds) // 2
    for at in range(0, half, SESSIONS):
        between_loads(spoilt, kinds[at : min(at + SESSIONS, half)])
    log = spoilt.setting.folder / "spoilt.log"
    found = count_found(log)
    during_loads(spoilt, kinds[half:])
    report.figure("trials", dict(spoilt.trials))
    report.figure("outcomes", dict(spoilt.outcomes))
    report.figure("files found spoilt between loads", found)
    report.figure("files found spoilt during loads", count_found(log) - found)
    report.require("trials tried", spoilt.trials.total(), at_least=len(kinds))
    report.require("wrong points", spoilt.outcomes["wrong points"], at_most=0)
    report.require("sessions not made anew", spoilt.outcomes["not made anew"], at_most=0)
    report.require("other refusals", sum(n for name, n in spoilt.outcomes.items() if name.startswith("refused")), at_most=0)
    report.require("files found spoilt", count_found(log), at_least=half // 2)
    return report


def count_found(log: pathlib.Path) -> int:
    return sum("[warning] cache: " in line for line in log.read_text(errors="replace").splitlines())


def between_loads(spoilt: Spoilt, kinds: list[str]) -> None:
    """A trial with each session, all of them while the server is down."""
    for number, kind in enumerate(kinds):
        spoilt.spoil(kind, number, in_place=True)
    with spoilt.start() as server, spoilt.caller(server, "between loads") as caller:
        for number in range(len(kinds)):
            spoilt.look(caller, number)
        spoilt.restore(caller)
    shutil.rmtree(spoilt.cache)  # what no view has looked at is spoilt still
    shutil.copytree(spoilt.good, spoilt.cache)


def during_loads(spoilt: Spoilt, kinds: list[str]) -> None:
    over = threading.Event()
    with spoilt.start("--max-sessions", ROOM) as server, spoilt.caller(server, "during loads") as caller:
        readers = [threading.Thread(target=read_all, args=(spoilt, server, n, over), daemon=True) for n in range(READERS)]
        for reader in readers:
            reader.start()
        for trial, kind in enumerate(kinds):
            number = trial % SESSIONS
            spoilt.spoil(kind, number, in_place=False)
            spoilt.look(caller, number)
            if trial % SESSIONS == SESSIONS - 1:
                spoilt.restore(caller)
        over.set()
        for reader in readers:
            reader.join()


def read_all(spoilt: Spoilt, server: Server, reader: int, over: threading.Event) -> None:
    """Asks for one session after the other; what they answer, the history tells."""
    with spoilt.caller(server, f"reader {reader}") as caller:
        number = reader
        while not over.is_set() and server.process.poll() is None:
            caller.sample(spoilt.ids[number % SESSIONS], spoilt.views[number % SESSIONS])
            number += 1
