"""The proxy reads its settings anew, and is stopped and started: viewers go on within a second.

Streams through the proxy as it was end a while after it has read its settings: they have to go on through the new one, too.
"""

from __future__ import annotations

import asyncio

from cluster.edge import Edge
from cluster.scene import Scene, all_see, until
from cluster.viewers import Crowd
from hold.history import now
from hold.kills import CALM
from hold.report import Report, quantile
from hold.servers import Setting

REPLICAS, GRPC, WEB = 3, 32, 8
STOP_SECONDS = 1  # that streams get after the proxy has read its settings anew


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    times = setting.pick(full=20, quick=3)
    with Edge(setting, REPLICAS, *CALM, stop_seconds=STOP_SECONDS) as edge:
        scene = Scene(setting, edge)
        crowd, reloads, restarts = asyncio.run(run_all(scene, times))
    report.figure("reloads, and restarts", times)
    report.figure("views", crowd.views)
    report.figure("streams that broke", len(crowd.breaks))
    for what, gaps in (("reload", reloads), ("restart", restarts)):
        report.figure(f"ms median from a {what} to new points", 1000 * quantile(gaps, 0.5))
        report.require(f"s from a {what} to new points, longest", max(gaps, default=0), at_most=1, timed=True)
    report.require("views that failed", len(crowd.failed), at_most=0)
    report.notes += crowd.failed[:3]
    return report


async def run_all(scene: Scene, times: int) -> tuple[Crowd, list[float], list[float]]:
    edge = scene.edge
    reloads: list[float] = []
    restarts: list[float] = []
    async with scene.crowd(GRPC, WEB) as (crowd, viewers):
        for _ in range(times):
            at = now()
            breaks = len(crowd.breaks)
            await asyncio.to_thread(edge.reload_proxy)
            await asyncio.sleep(2 * STOP_SECONDS)  # the streams of the old one are over
            reloads += await gaps_of(crowd, breaks)
            await asyncio.to_thread(edge.wait_until_up)
            scene.setting.history.tell("fault", server=edge.name, begin=at, end=now())
            await all_see(viewers, crowd)

            at = now()
            edge.stop_proxy()
            edge.start_proxy(ready=False)
            await until(lambda at=at: all(viewer.arrival_after(at) < float("inf") for viewer in viewers))  # type: ignore[misc]
            restarts += [viewer.arrival_after(at) - at for viewer in viewers]
            await asyncio.to_thread(edge.wait_until_up)
            scene.setting.history.tell("fault", server=edge.name, begin=at, end=now())
            await all_see(viewers, crowd)
    return crowd, reloads, restarts


async def gaps_of(crowd: Crowd, first: int) -> list[float]:
    """Seconds from when each stream broke to new points."""
    broken = crowd.breaks[first:]
    await until(lambda: all(one.viewer.arrival_after(one.at) < float("inf") for one in broken))
    return [one.viewer.arrival_after(one.at) - one.at for one in broken]
