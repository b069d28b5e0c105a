# SPDX-License-Identifier: Apache-2.0
"""The surface of a session itself, as a file of Draco."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from curvecast.errors import bad_answer
from curvecast.v1 import curvecast_pb2 as v1

MESH_HEADER = b"DRACO"
MESH_KIND = 7  # of the byte that is 1 for a mesh


@dataclasses.dataclass(frozen=True, eq=False)
class SurfaceFile:
    """The repaired mesh that a session lies on."""

    drc: bytes  #: a mesh as Draco's decoders open it: positions, colours of vertices where there are any
    vertices: int
    triangles: int
    origin: npt.NDArray[np.float64]  #: (3,), units: positions are relative to it
    crease_degrees: float  #: edges between faces whose normals are further apart are sharp


def join_surface(messages: Iterator[v1.GetSurfaceResponse]) -> SurfaceFile:
    """Joins the messages of an answer to the surface. Error DATA_LOSS: the messages break the protocol. What the file says is not
    looked at."""
    first = next(messages, v1.GetSurfaceResponse())
    if not first.HasField("info"):
        raise bad_answer("the server sent a surface without its beginning")
    info = first.info
    drc = bytearray()
    for message in messages:
        if message.HasField("info"):
            raise bad_answer("the server sent a surface with two beginnings")
        drc += message.chunk
        if len(drc) > info.bytes:
            break
    if len(drc) != info.bytes:
        raise bad_answer(f"the server sent {len(drc)} bytes of a surface of {info.bytes}")
    if not drc.startswith(MESH_HEADER) or len(drc) <= MESH_KIND or drc[MESH_KIND] != 1:
        raise bad_answer("the server sent a surface that is no mesh in Draco's form")
    origin = np.array([info.origin.x, info.origin.y, info.origin.z])
    return SurfaceFile(bytes(drc), info.vertices, info.triangles, origin, info.crease_degrees)
