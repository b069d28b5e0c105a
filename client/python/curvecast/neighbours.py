# SPDX-License-Identifier: Apache-2.0
"""The neighbours of the points of a set, as the server finds them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast.columns import Columns, read_column
from curvecast.errors import bad_answer
from curvecast.points import Points, decode_blocks
from curvecast.protocol import MAX_NEIGHBOUR_PAIRS
from curvecast.v1 import curvecast_pb2 as v1

COLUMNS: Columns = {"counts": ("<u4", 1), "indices": ("<u4", 1), "distances": ("<f4", 1)}


@dataclasses.dataclass(frozen=True, eq=False)
class Neighbours:
    """The neighbours of N points, straight through space.

    Of the k nearest, `indices` and `distances` have the shape (N, k), the nearest first; k is less than was asked for
    where there are fewer other points. Of all within a radius, they have the shape (P,), the lists of all points one
    after the other, each by index: `starts` tells where they begin, as scipy.sparse.csr_array has it."""

    points: Points
    indices: npt.NDArray[np.uint32]  #: among the points
    distances: npt.NDArray[np.float32]  #: units
    starts: npt.NDArray[np.int64]  #: (N + 1,): the neighbours of point i are entries starts[i] to starts[i + 1] - 1

    def of(self, i: int) -> npt.NDArray[np.uint32]:
        """Returns the indices of the neighbours of point i."""
        return self.indices.reshape(-1)[self.starts[i] : self.starts[i + 1]]


def decode_neighbours(messages: Iterable[v1.FindNeighboursResponse], most: int, k: int | None) -> Neighbours:
    """Joins the messages of an answer. `most`: so many points may come. `k`: neighbours asked for of each; None: any number. Error
    DATA_LOSS: another number of points or neighbours, or neighbours that are no other points of the set."""
    blocks: list[v1.PointBlock] = []
    statistics = v1.FrameStatistics()
    parts: dict[str, list[npt.NDArray[Any]]] = {name: [] for name in COLUMNS}
    points = pairs = 0
    for message in messages:
        kind = message.WhichOneof("update")
        if kind == "points":
            points += message.points.points.count
            blocks.append(message.points.points)
            if message.points.HasField("statistics"):
                statistics.CopyFrom(message.points.statistics)
        elif kind == "neighbours":
            pairs += len(message.neighbours.indices) // 4
            for name, column in COLUMNS.items():
                parts[name].append(read_column(name, getattr(message.neighbours, name), column))
        if points > most or pairs > MAX_NEIGHBOUR_PAIRS:  # a server that sends on and on must not fill this machine's memory
            raise bad_answer(f"the server sent {points} points with {pairs} neighbours; it was asked for {most} points")
    if points == 0:
        raise bad_answer("the server sent no points")
    decoded = dataclasses.replace(decode_blocks(blocks), statistics=statistics)
    counts, indices, distances = (np.concatenate([np.zeros(0, kind[0]), *parts[name]]) for name, kind in COLUMNS.items())
    starts = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    if len(counts) != points or len(indices) != starts[-1] or len(distances) != starts[-1]:
        raise bad_answer(f"the server sent {len(indices)} neighbours of {len(counts)} points where {starts[-1]} of {points} belong")
    if (indices >= points).any() or (indices == np.repeat(np.arange(points), counts)).any() or (distances < 0).any():
        raise bad_answer(f"the server sent a neighbour that is no other one of {points} points")
    if k is not None:
        width = min(k, points - 1)
        if (counts != width).any():
            raise bad_answer(f"asked for {width} neighbours of each point, but the server sent others")
        indices, distances = indices.reshape(points, width), distances.reshape(points, width)
    return Neighbours(decoded, indices, distances, starts)
