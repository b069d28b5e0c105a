"""Replicas are stopped in order, again and again, and all one after the other: viewers go on with another, and no view fails."""

from __future__ import annotations

import asyncio
import dataclasses

from cluster.edge import Edge
from cluster.scene import Scene, until
from cluster.traffic import Traffic
from hold.history import now
from hold.kills import CALM
from hold.report import Report, quantile
from hold.servers import Setting

REPLICAS, GRPC, WEB = 3, 32, 8
END_SECONDS = 15.0  # that a replica may take to end


@dataclasses.dataclass
class Found:
    ends: list[float] = dataclasses.field(default_factory=list)  # seconds from SIGTERM to the end
    longest: list[float] = dataclasses.field(default_factory=list)  # view of each drain, seconds
    statuses: list[int] = dataclasses.field(default_factory=list)


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    drains = setting.pick(full=50, quick=REPLICAS)
    with Edge(setting, REPLICAS, *CALM) as edge:
        scene = Scene(setting, edge)
        traffic, found = Traffic(scene), Found()
        failed, views, breaks = asyncio.run(drain_all(scene, traffic, drains, found))
        traffic.look_at_all()
    report.figure("drains", drains)
    report.figure("views", views)
    report.figure("streams that moved", breaks)
    report.figure("s median from SIGTERM to the end", quantile(found.ends, 0.5))
    report.figure("calls repeated", traffic.repeated)
    report.require("views that failed", len(failed), at_most=0)
    report.require("calls that failed", len(traffic.failed), at_most=0)
    report.require("sessions and uploads lost", traffic.lost, at_most=0)
    report.require("replicas that ended otherwise than in order", sum(status != 0 for status in found.statuses), at_most=0)
    report.require("s until a view had points, longest", max(found.longest, default=0), at_most=1, timed=True)
    report.require("s until a replica had ended, longest", max(found.ends, default=0), at_most=END_SECONDS, timed=True)
    report.notes += [*failed[:3], *traffic.failed[:3]]
    return report


async def drain_all(scene: Scene, traffic: Traffic, drains: int, found: Found) -> tuple[list[str], int, int]:
    edge = scene.edge
    async with scene.crowd(GRPC, WEB) as (crowd, viewers):
        with traffic.running():
            for number in range(drains):
                name = f"r{1 + number % REPLICAS}"
                at = now()
                await asyncio.to_thread(edge.replicas[name].stop)
                found.ends.append(now() - at)
                found.statuses.append(edge.replicas[name].process.returncode)
                await edge.restart_replica(name)
                await until(lambda: all(viewer.replica for viewer in viewers))
                found.longest.append(crowd.longest(at, now()))
                scene.setting.history.tell("fault", server=edge.name, begin=at, end=now())
    return crowd.failed, crowd.views, len(crowd.breaks)
