# SPDX-License-Identifier: Apache-2.0
"""A surface cut into discs and mapped to the square."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from curvecast.columns import join_discs
from curvecast.errors import bad_answer
from curvecast.v1 import curvecast_pb2 as v1

COLUMNS = {
    "positions": ("<f8", 3),
    "uv": ("<f8", 2),
    "triangles": ("<u4", 3),
    "faces": ("<u4", 1),
    "area_ratios": ("<f8", 1),
    "border": ("<u4", 1),
    "border_cuts": ("u1", 1),
}


@dataclasses.dataclass(frozen=True, eq=False)
class ParameterDisc:
    """A topological disc: V vertices, T triangles, B vertices of its border."""

    positions: npt.NDArray[np.float64]  #: (V, 3), units
    uv: npt.NDArray[np.float64]  #: (V, 2), in [0, 1]
    triangles: npt.NDArray[np.uint32]  #: (T, 3): vertices of the disc
    faces: npt.NDArray[np.uint32]  #: (T,): the polygon of the mesh's file that holds the triangle
    area_ratios: npt.NDArray[np.float64]  #: (T,): surface area over uv area
    border: npt.NDArray[np.uint32]  #: (B,): vertices of the border loop, counter-clockwise
    border_cuts: npt.NDArray[np.bool_]  #: (B,): whether the edge from there to the next is a cut


@dataclasses.dataclass(frozen=True, eq=False)
class ParameterMesh:
    """The discs of a mesh, mapped to the square."""

    info: v1.ParameterMeshInfo  #: the mesh and its distortion
    discs: Sequence[ParameterDisc]


def decode_parameter_mesh(messages: Iterator[v1.GetParameterMeshResponse]) -> ParameterMesh:
    """Joins the messages of an answer to the parameter mesh. Error DATA_LOSS: the messages break the protocol."""
    first = next(messages, v1.GetParameterMeshResponse())
    chunks = [message.chunk for message in (first, *messages) if message.HasField("chunk")]
    discs = []
    for columns in join_discs("the parameter mesh", chunks, COLUMNS, first.info.discs):
        columns["border_cuts"] = columns["border_cuts"] != 0
        disc = ParameterDisc(**columns)
        vertices, triangles = len(disc.positions), len(disc.triangles)
        if not (
            len(disc.uv) == vertices
            and len(disc.faces) == len(disc.area_ratios) == triangles
            and len(disc.border) == len(disc.border_cuts)
            and max(disc.triangles.max(initial=0), disc.border.max(initial=0)) < vertices
            and disc.faces.max(initial=0) < first.info.mesh.faces
        ):
            raise bad_answer("the server sent a parameter mesh that makes no sense")
        discs.append(disc)
    return ParameterMesh(first.info, discs)
