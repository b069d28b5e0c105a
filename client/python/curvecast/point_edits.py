"""Takes a delta frame in: what the server changed in the list of points that the client holds."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
import numpy.typing as npt

from curvecast.errors import bad_answer
from curvecast.points import COLUMNS, Points
from curvecast.protocol import MAX_POINTS, RADIUS_RUNGS, RADIUS_RUNGS_PER_OCTAVE
from curvecast.v1 import curvecast_pb2 as v1


def apply_edits(held: Points, edits: v1.PointEdits, added: Points) -> Points:
    """The list after the edits, in new arrays; `added` are the points of the frame. Error DATA_LOSS: edits that do not fit the
    list: indices that do not ascend or lie outside, other columns or another origin than those held."""
    removed = _indices(edits.removed, len(held), "removed")
    size = len(held) - len(removed) + len(added)
    if size > MAX_POINTS:
        raise bad_answer(f"there would be {size} points after it")
    places = _indices(edits.added, size, "added")
    if len(places) != len(added):
        raise bad_answer(f"added has {len(places)} indices for {len(added)} points")
    if len(held) and len(added) and not np.array_equal(held.origin, added.origin):
        raise bad_answer("the points that are added have another origin than those held")
    stays = np.ones(len(held), bool)
    stays[removed] = False
    is_old = np.ones(size, bool)
    is_old[places] = False
    source = np.empty(size, np.int64)  # of each point: in the list held, followed by those added
    source[is_old] = np.flatnonzero(stays)
    source[places] = np.arange(len(held), len(held) + len(added))
    columns = {}
    for name in COLUMNS:
        parts = [getattr(points, name) for points in (held, added) if len(points)] or [getattr(held, name)]
        if any((part is None) != (parts[0] is None) for part in parts):
            raise bad_answer("the points that are added have other attributes than those held")
        if parts[0] is not None:
            columns[name] = np.concatenate(parts).take(source, axis=0)
    if len(edits.resized):
        _resize(edits, columns.get("radii", np.empty(0, "<f4")))
    return Points(held.origin if len(held) else added.origin, **columns)


def _indices(steps: Collection[int], size: int, what: str) -> npt.NDArray[np.int64]:
    """The first index, then the differences; ascending, and below `size`."""
    indices = np.fromiter(steps, np.int64, len(steps))
    if (indices[1:] == 0).any():
        raise bad_answer(f"{what} holds an index twice")
    np.cumsum(indices, out=indices)  # up to 2^25 steps of 32 bits in a message: far from 2^63
    if len(indices) and indices[-1] >= size:
        raise bad_answer(f"{what} holds index {indices[-1]} of {size}")
    return indices


def _resize(edits: v1.PointEdits, radii: npt.NDArray[np.float32]) -> None:
    largest = float(edits.radius_max)
    if not (largest > 0 and math.isfinite(largest)):
        raise bad_answer("radius_max is no radius")
    codes = np.fromiter(edits.resized, np.int64, len(edits.resized))
    places = np.cumsum(codes >> 1)
    if places[-1] >= len(radii):
        raise bad_answer(f"resized holds index {places[-1]} of {len(radii)}")
    # All steps of a point together: they all go the same way.
    points, first = np.unique(places, return_index=True)
    steps = np.add.reduceat(np.where(codes & 1, 1, -1), first)
    rungs = np.rint(RADIUS_RUNGS_PER_OCTAVE * np.log2(largest / radii[points].astype(np.float64))) + steps
    radii[points] = largest * np.exp2(-np.clip(rungs, 0, RADIUS_RUNGS - 1) / RADIUS_RUNGS_PER_OCTAVE)
