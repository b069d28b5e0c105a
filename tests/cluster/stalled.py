"""A quarter of the streams through the proxy never reads, with the largest frames and with small ones: nobody else waits for it."""

from __future__ import annotations

from cluster.edge import Edge
from hold import stalled
from hold.calls import Caller
from hold.kills import CALM
from hold.report import Report
from hold.servers import Setting

REPLICAS = 3


def run(setting: Setting) -> Report:
    with (
        Edge(setting, REPLICAS, *CALM, *stalled.options(setting)) as edge,
        Caller(edge, setting.history, "maker", stalled.BUSY) as maker,
    ):
        session = stalled.prepare(maker)
        maker.wait_until_cached([session])  # for all of them
        return stalled.measure(setting, edge, session)
