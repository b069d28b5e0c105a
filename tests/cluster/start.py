"""From the start of a replica whose cache holds 20 sessions until it is ready: less than a second, before a store too."""

from __future__ import annotations

import time

from cluster.scene import make
from hold.calls import Caller
from hold.history import now
from hold.kills import CALM, Wanted
from hold.report import Report, quantile
from hold.servers import READY_SECONDS, Server, Setting

SESSIONS, RINGS, POINTS = 20, 24, 4000
LOOK = 0.002  # seconds between looks


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    cache = setting.folder / "cache"
    sessions = [Wanted(seed, RINGS, POINTS) for seed in range(SESSIONS)]
    with Server(setting, "maker", *CALM, cache=cache) as server, Caller(server, setting.history, "maker") as caller:
        for wanted in sessions:
            make(caller, wanted)
        saved = caller.wait_until_cached([wanted.session for wanted in sessions])
    seconds, served = [], 0
    store = setting.folder / "store"
    store.mkdir()
    plain = setting.pick(full=15, quick=2)
    for number in range(setting.pick(full=20, quick=3)):
        before = ("--store", f"file://{store}") if number >= plain else ()
        begin = now()
        with Server(setting, f"again {number}", *CALM, *before, cache=cache) as server:
            while server.get("/readyz")[0] != 200:
                if now() > begin + READY_SECONDS:
                    raise RuntimeError("it is never ready")
                time.sleep(LOOK)
            seconds.append(now() - begin)
            with Caller(server, setting.history, "looker") as caller:
                served += sum(caller.sample(wanted.session, wanted.view).is_ok for wanted in sessions)
    report.figure("starts", len(seconds))
    report.figure("s median from start to ready", quantile(seconds, 0.5))
    report.require("sessions in the cache", saved, at_least=SESSIONS)
    report.require("sessions that were not served", len(seconds) * SESSIONS - served, at_most=0)
    report.require("s from start to ready, longest", max(seconds), at_most=1, timed=True)
    return report
