"""kill -9 of a replica that somebody looks at: others do not notice, and he goes on with another; nothing is lost or made again.

32 viewers by gRPC and 8 by WebSocket, uploads, new sessions, and looks at old ones.
"""

from __future__ import annotations

import asyncio
import dataclasses

from cluster.edge import Edge
from cluster.scene import Scene, all_see, until
from cluster.traffic import Traffic, made_again
from hold.history import now
from hold.kills import CALM
from hold.report import Report, quantile
from hold.servers import Setting

REPLICAS, GRPC, WEB = 3, 32, 8
MOMENT = 0.5  # seconds within which a kill comes


@dataclasses.dataclass
class Found:
    gaps: list[float] = dataclasses.field(default_factory=list)  # seconds from a kill to new points, of each viewer of the killed
    noticed: list[float] = dataclasses.field(default_factory=list)  # seconds from a kill to the end of a stream with the killed
    tries: int = 0  # streams with others that came to nothing before one had points
    elsewhere: list[str] = dataclasses.field(default_factory=list)  # breaks of streams with others
    ready: list[float] = dataclasses.field(default_factory=list)  # seconds from a start until the proxy sends calls there


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    kills = setting.pick(full=100, quick=5)
    with Edge(setting, REPLICAS, *CALM) as edge:
        scene = Scene(setting, edge)
        traffic, found = Traffic(scene), Found()
        failed, views = asyncio.run(kill_all(scene, traffic, kills, found))
        traffic.look_at_all()
    setting.history.flush()
    report.figure("kills", kills)
    report.figure("views", views)
    report.figure("streams that broke with their replica", len(found.gaps))
    report.figure("ms median from a kill to new points", 1000 * quantile(found.gaps, 0.5))
    report.figure("ms median from a kill to the end of a stream", 1000 * quantile(found.noticed, 0.5))
    report.figure("streams that came to nothing before others had points", found.tries)
    report.figure("ms median until a replica was back", 1000 * quantile(found.ready, 0.5))
    report.figure("uploads acknowledged", len(traffic.uploads))
    report.figure("sessions made", len(traffic.sessions))
    report.figure("calls repeated", traffic.repeated)
    report.require("streams elsewhere that broke", len(found.elsewhere), at_most=0)
    report.require("views that failed", len(failed), at_most=0)
    report.require("calls that failed", len(traffic.failed), at_most=0)
    report.require("sessions and uploads lost", traffic.lost, at_most=0)
    report.require("cached sessions made again", made_again(setting.history.path), at_most=0)
    report.require("s from a kill to new points, p99", quantile(found.gaps, 0.99), at_most=1, timed=True)
    report.require("s from a kill to new points, longest", max(found.gaps, default=0), at_most=2, timed=True)
    report.notes += [*found.elsewhere[:3], *failed[:3], *traffic.failed[:3]]
    return report


async def kill_all(scene: Scene, traffic: Traffic, kills: int, found: Found) -> tuple[list[str], int]:
    edge, chance = scene.edge, scene.setting.random
    async with scene.crowd(GRPC, WEB) as (crowd, viewers):
        with traffic.running():
            for _ in range(kills):
                await asyncio.sleep(MOMENT * chance.random())
                await all_see(viewers, crowd)
                victim = chance.choice(viewers).replica
                hit = [viewer for viewer in viewers if viewer.replica == victim]
                breaks, at = len(crowd.breaks), now()
                edge.replicas[victim].kill()
                began = now()
                server = edge.start_replica(victim, ready=False)
                await until(lambda at=at, hit=hit: all(viewer.arrival_after(at) < float("inf") for viewer in hit))  # type: ignore[misc]
                found.gaps += [viewer.arrival_after(at) - at for viewer in hit]
                broken = [one for one in crowd.breaks[breaks:] if one.viewer in hit]
                found.noticed += [one.at - at for one in broken if one.replica]
                found.tries += sum(not one.replica for one in broken)
                await asyncio.to_thread(server.wait_until_ready)
                await asyncio.to_thread(edge.wait_until_up)
                found.ready.append(now() - began)
                others = [one for one in crowd.breaks[breaks:] if one.viewer not in hit]
                found.elsewhere += [f"with {one.replica or 'none'}, not {victim}: {one.error}" for one in others]
                scene.setting.history.tell("fault", server=edge.name, begin=at, end=now())
    return crowd.failed, crowd.views
