# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes that a server makes of points."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from curvecast.columns import read_column
from curvecast.density import enum_name
from curvecast.errors import bad_answer
from curvecast.points import Points, decode_blocks
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import View


@dataclasses.dataclass(frozen=True, eq=False)
class TriangleMesh:
    """A manifold mesh of a surface."""

    vertices: Points  #: with normals, colours where the surface has any, and places on the file's mesh
    triangles: npt.NDArray[np.uint32]  #: (T, 3): vertices, counter-clockwise seen from outside
    info: v1.RemeshInfo  #: curvecast.v1.RemeshInfo: components, genus, boundary_loops

    def __len__(self) -> int:
        return len(self.triangles)


def remesh_request(view: View, relaxations: int, fit: bool, feature_degrees: float, method: str) -> v1.RemeshRequest:
    """Makes the message of the API, of no session yet. ValueError: as of View.to_proto(), or a method that there is not."""
    return v1.RemeshRequest(
        sample=view.to_proto(),
        relaxations=relaxations,
        fit=fit,
        feature_degrees=feature_degrees,
        method=enum_name(v1.RemeshMethod, "REMESH_METHOD", method),
    )


def decode_mesh(messages: Iterator[v1.RemeshResponse]) -> TriangleMesh:
    """Joins the messages of an answer to the mesh. Error DATA_LOSS: the messages break the protocol."""
    all_messages = list(messages)
    info = next((message.info for message in all_messages if message.HasField("info")), None)
    if info is None:
        raise bad_answer("the server sent no mesh")
    chunks = [message.chunk for message in all_messages if message.HasField("chunk")]
    vertices = decode_blocks(chunk.vertices for chunk in chunks if chunk.HasField("vertices"))
    triangles = read_column("triangles", b"".join(chunk.triangles for chunk in chunks), ("<u4", 3))
    if len(vertices) != info.vertices or len(triangles) != info.triangles:
        sent = f"{len(vertices)} vertices and {len(triangles)} triangles"
        raise bad_answer(f"the server sent {sent}, not {info.vertices} and {info.triangles}")
    a, b, c = triangles.T
    if triangles.max(initial=0) >= max(len(vertices), 1) or ((a == b) | (b == c) | (c == a)).any():
        raise bad_answer("the server sent a triangle that is not between three vertices")
    return TriangleMesh(vertices, triangles, info)
