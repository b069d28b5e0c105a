# SPDX-License-Identifier: Apache-2.0
"""The Hilbert curve of a session, in the parameter square and on the surface."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from curvecast.columns import join_discs
from curvecast.errors import bad_answer
from curvecast.protocol import MAX_CURVE_LEVEL
from curvecast.v1 import curvecast_pb2 as v1

COLUMNS = {"positions": ("<f4", 3), "normals": ("<i2", 3), "areas": ("<f4", 1), "cells": ("<u4", 2), "levels": ("u1", 1)}


@dataclasses.dataclass(frozen=True, eq=False)
class CurveDisc:
    """The curve of one disc: L vertices in curve order. Each is the centre of a quad of the parameter square."""

    positions: npt.NDArray[np.float32]  #: (L, 3), units, relative to the curve's origin
    normals: npt.NDArray[np.float32]  #: (L, 3), unit vectors to 1/32767
    areas: npt.NDArray[np.float32]  #: (L,): surface that the vertex stands for, squared units
    cells: npt.NDArray[np.uint32]  #: (L, 2): the quad's lower left corner, in units of 2^-30
    levels: npt.NDArray[np.uint8]  #: (L,): the quad's side is 2^-level

    def __len__(self) -> int:
        return len(self.levels)

    def centres(self) -> npt.NDArray[np.float64]:
        """Returns the centres of the quads: (L, 2), in [0, 1]."""
        centres: npt.NDArray[np.float64] = np.ldexp(self.cells, -MAX_CURVE_LEVEL) + np.ldexp(0.5, -self.levels.astype(int))[:, None]
        return centres


@dataclasses.dataclass(frozen=True, eq=False)
class Curve:
    """The curve over all discs."""

    revision: int
    origin: npt.NDArray[np.float64]  #: (3,), units: positions are relative to it
    discs: Sequence[CurveDisc]


def decode_curve(messages: Iterator[v1.GetCurveResponse]) -> Curve:
    """Joins the messages of an answer to the curve. Error DATA_LOSS: the messages break the protocol."""
    first = next(messages, v1.GetCurveResponse())
    info = first.info
    chunks = [message.chunk for message in (first, *messages) if message.HasField("chunk")]
    discs = []
    for columns in join_discs("the curve", chunks, COLUMNS, info.discs):
        if len({len(column) for column in columns.values()}) != 1 or columns["levels"].max(initial=0) > MAX_CURVE_LEVEL:
            raise bad_answer("the server sent a curve that makes no sense")
        columns["normals"] = columns["normals"] / np.float32(32767)
        discs.append(CurveDisc(**columns))
    if sum(map(len, discs)) != info.curve_vertices:
        raise bad_answer(f"the server sent {sum(map(len, discs))} curve vertices, not {info.curve_vertices}")
    return Curve(info.revision, np.array([info.origin.x, info.origin.y, info.origin.z]), discs)
