# SPDX-License-Identifier: Apache-2.0
"""Applies a delta frame: what the server changed in the list of points that the client has."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
import numpy.typing as npt

from curvecast.errors import bad_answer
from curvecast.points import Points, points_of
from curvecast.protocol import MAX_POINTS, RADIUS_RUNGS, RADIUS_RUNGS_PER_OCTAVE
from curvecast.v1 import curvecast_pb2 as v1


def apply_edits(before: Points, edits: v1.PointEdits, added: Points) -> Points:
    """Makes the list after the edits, in new arrays, of the list `before` and the points `added` of the frame. Error DATA_LOSS:
    edits that do not fit the list: indices that do not ascend or lie outside, other columns or another origin than those of the
    list."""
    removed = _indices(edits.removed, len(before), "removed")
    size = len(before) - len(removed) + len(added)
    if size > MAX_POINTS:
        raise bad_answer(f"there would be {size} points after it")
    added_at = _indices(edits.added, size, "added")
    if len(added_at) != len(added):
        raise bad_answer(f"added has {len(added_at)} indices for {len(added)} points")
    if len(before) and len(added) and not np.array_equal(before.origin, added.origin):
        raise bad_answer("the points that are added have another origin than those held")
    stays = np.ones(len(before), bool)
    stays[removed] = False
    is_old = np.ones(size, bool)
    is_old[added_at] = False
    source = np.empty(size, np.int64)  # index of each point in the list before, followed by the points added
    source[is_old] = np.flatnonzero(stays)
    source[added_at] = np.arange(len(before), len(before) + len(added))
    parts = [points.columns() for points in (before, added) if len(points)] or [before.columns()]
    if any(part.keys() != parts[0].keys() for part in parts):
        raise bad_answer("the points that are added have other attributes than those held")
    columns = {name: np.concatenate([part[name] for part in parts]).take(source, axis=0) for name in parts[0]}
    if len(edits.resized):
        _resize(edits, columns.get("radii", np.empty(0, "<f4")))
    return points_of(before.origin if len(before) else added.origin, columns)


def _indices(steps: Collection[int], size: int, what: str) -> npt.NDArray[np.int64]:
    """Adds up `steps`, the first index and then differences, to indices that ascend and are below `size`."""
    indices = np.fromiter(steps, np.int64, len(steps))
    if (indices[1:] == 0).any():
        raise bad_answer(f"{what} holds an index twice")
    np.cumsum(indices, out=indices)  # up to 2^25 steps of 32 bits in a message: far from 2^63
    if len(indices) and indices[-1] >= size:
        raise bad_answer(f"{what} holds index {indices[-1]} of {size}")
    return indices


def _resize(edits: v1.PointEdits, radii: npt.NDArray[np.float32]) -> None:
    """Moves radii from rung to rung, in place."""
    largest = float(edits.radius_max)
    if not (largest > 0 and math.isfinite(largest)):
        raise bad_answer("radius_max is no radius")
    codes = np.fromiter(edits.resized, np.int64, len(edits.resized))
    indices = np.cumsum(codes >> 1)
    if indices[-1] >= len(radii):
        raise bad_answer(f"resized holds index {indices[-1]} of {len(radii)}")
    # All steps of a disc go the same way, so that their sum is one step.
    points, first = np.unique(indices, return_index=True)
    steps = np.add.reduceat(np.where(codes & 1, 1, -1), first)
    rungs = np.rint(RADIUS_RUNGS_PER_OCTAVE * np.log2(largest / radii[points].astype(np.float64))) + steps
    radii[points] = largest * np.exp2(-np.clip(rungs, 0, RADIUS_RUNGS - 1) / RADIUS_RUNGS_PER_OCTAVE)
