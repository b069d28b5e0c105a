# SPDX-License-Identifier: Apache-2.0
"""Point sets as servers send them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator

from curvecast.errors import bad_answer
from curvecast.points import Points, decode_blocks
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1


def decode_sample(messages: Iterable[v1.ResampleResponse], sample: v1.SampleRequest) -> Points:
    """Joins the messages of an answer to a request for points. Error DATA_LOSS: they are not as many as were asked for."""
    most = sample.points if sample.WhichOneof("budget") == "points" else MAX_POINTS
    statistics = v1.FrameStatistics()

    def blocks() -> Iterator[v1.PointBlock]:
        count = 0
        for message in messages:
            count += message.points.count
            if count > most:  # a server that sends on and on must not fill this machine's memory
                raise bad_answer(f"the server sent more than the {most} points asked for")
            if message.HasField("statistics"):
                statistics.CopyFrom(message.statistics)
            if message.HasField("points"):
                yield message.points
        if count == 0:
            raise bad_answer("the server sent no points")

    points = decode_blocks(blocks())
    may_be_fewer = sample.sampler == v1.SAMPLER_PROGRESSIVE or any(getattr(t.distance, "global") for t in sample.density)
    if sample.WhichOneof("budget") == "points" and len(points) < most and not may_be_fewer:
        raise bad_answer(f"asked for {most} points, but the server sent {len(points)}")
    return dataclasses.replace(points, statistics=statistics)
