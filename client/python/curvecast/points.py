# SPDX-License-Identifier: Apache-2.0
"""Point sets as arrays, and how the API's blocks become them."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from google.protobuf.message import Message

from curvecast import notebook
from curvecast.columns import Columns, read_column
from curvecast.errors import bad_answer
from curvecast.v1 import curvecast_pb2 as v1

#: (data, radius_min, radius_max, count) -> positions, normals, radii and colours; None: built without Python's headers.
_decode: Callable[[bytes, float, float, int], tuple[bytes, bytes, bytes, bytes]] | None = None
with contextlib.suppress(ModuleNotFoundError):  # a module that is there and does not load is an error
    from curvecast._draco import decode as _decode

#: Whether points can be asked for with encoding="draco".
HAS_DRACO = _decode is not None

Float32s = npt.NDArray[np.float32]

COLUMNS: Columns = {
    "positions": ("<f4", 3),
    "normals": ("<f4", 3),
    "radii": ("<f4", 1),
    "colours": ("u1", 3),
    "curvatures": ("<f4", 2),
    "ranks": ("<u4", 1),
    "faces": ("<u4", 1),
    "barycentric": ("<f4", 2),
    "directions": ("<f4", 3),
}

SCALAR = "scalar "  # before the names of the mesh's own numbers, among those of columns

LIMITS = {
    int(v1.POINT_LIMIT_UNSPECIFIED): None,
    int(v1.POINT_LIMIT_BYTES): "bytes",
    int(v1.POINT_LIMIT_DENSITY): "density",
    int(v1.POINT_LIMIT_SERVER): "server",
    int(v1.POINT_LIMIT_COMING): "coming",
}


@dataclasses.dataclass(frozen=True, eq=False)
class Points:
    """N points along the curve. A point is at origin + position. None: a column that the mesh lacks or the view did not select."""

    origin: npt.NDArray[np.float64]  #: (3,), units
    positions: Float32s  #: (N, 3), units
    normals: Float32s | None = None  #: (N, 3), unit vectors
    radii: Float32s | None = None  #: (N,), units: of a splat; neighbouring discs overlap
    colours: npt.NDArray[np.uint8] | None = None  #: (N, 3): red, green, blue (sRGB)
    curvatures: Float32s | None = None  #: (N, 2), 1/unit: least and largest principal curvature
    ranks: npt.NDArray[np.uint32] | None = None  #: (N,): of the progressive sampler
    faces: npt.NDArray[np.uint32] | None = None  #: (N,): polygons of the mesh's file, counted from 0
    barycentric: Float32s | None = None  #: (N, 2): weights of that polygon's second and third corner
    #: (N, 3), unit tangents: of the least principal curvature, in one of their two senses; the largest is normals x directions
    directions: Float32s | None = None
    #: the mesh's numbers under their names, (N,) each, NaN and infinities as in the file; empty: not selected, or it has none
    scalars: Mapping[str, Float32s] = dataclasses.field(default_factory=dict)
    #: how the server made them: its times, .refining: better points are being made, .wanted_points: see limit
    statistics: v1.FrameStatistics = dataclasses.field(default_factory=v1.FrameStatistics)

    def __len__(self) -> int:
        return len(self.positions)

    def _repr_html_(self) -> str:
        return notebook.points_html(self)

    @property
    def limit(self) -> str | None:
        """Says why there are fewer points than statistics.wanted_points: bytes, density, server or coming, as PointLimit of the API
        has them. None: there are as many."""
        return LIMITS.get(self.statistics.limit, "unknown")  # of a newer server

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """Returns the columns that are there, by name; those of `scalars` as "scalar NAME"."""
        own = {name: column for name in COLUMNS if (column := getattr(self, name)) is not None}
        return own | {SCALAR + name: values for name, values in self.scalars.items()}

    def world_positions(self) -> npt.NDArray[np.float64]:
        """Returns the positions in the frame of the mesh file: (N, 3) float64, units."""
        return self.origin + self.positions


def points_of(origin: npt.NDArray[np.float64], columns: Mapping[str, npt.NDArray[Any]]) -> Points:
    """Makes Points of columns as Points.columns() has them."""
    own: dict[str, Any] = {name: column for name, column in columns.items() if name in COLUMNS}
    scalars = {name.removeprefix(SCALAR): values for name, values in columns.items() if name not in COLUMNS}
    return Points(origin, **own, scalars=scalars)


def as_points(points: Points | npt.ArrayLike) -> Points:
    """Makes Points of an (N, 3) array of positions in the frame of a mesh file. Their origin is the middle of the positions, so
    that 32 bits suffice for what is left. ValueError: another shape."""
    if isinstance(points, Points):
        return points
    positions = np.asarray(points, dtype=np.float64)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(f"points are an array of shape (N, 3), not {positions.shape}")
    origin = 0.5 * (positions.min(axis=0) + positions.max(axis=0)) if len(positions) else np.zeros(3)
    return Points(origin, (positions - origin).astype("<f4"))


def encoded_bytes(block: v1.PointBlock) -> int:
    """Counts the bytes that the points of a block take on the wire."""
    fields: tuple[Message, ...] = (block.draco, block.raw, block.attributes, *block.attributes.scalars)
    return sum(len(value) for message in fields for _, value in message.ListFields() if isinstance(value, bytes))


def decode_blocks(blocks: Iterable[v1.PointBlock]) -> Points:
    """Decodes blocks that follow each other into one set of points, which can be written to. Error DATA_LOSS: blocks that break the
    protocol."""
    decoded = [_decode_block(block) for block in blocks]
    if not decoded:
        return Points(np.zeros(3), np.zeros((0, 3), "<f4"))
    origin = decoded[0].origin
    parts = [part.columns() | {"positions": _moved(part, origin)} for part in decoded]
    for part in parts:
        if odd := part.keys() ^ parts[0].keys():
            raise bad_answer(f"the server sent some blocks of points with {min(odd)} and others without")
    return points_of(origin, {name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def _moved(points: Points, origin: npt.NDArray[np.float64]) -> Float32s:
    if np.array_equal(points.origin, origin):
        return points.positions
    return (points.positions + (points.origin - origin)).astype("<f4")


def _decode_block(block: v1.PointBlock) -> Points:
    kind = block.WhichOneof("data")
    if kind == "raw":
        raw = block.raw
        data = {"positions": raw.positions, "normals": raw.normals, "radii": raw.radii}
        if raw.colours:
            data["colours"] = raw.colours
    elif kind == "draco":
        data = _decode_draco(block.draco, block.count)
    else:
        raise bad_answer("the server sent a block of points that is neither Draco nor raw")
    for field, value in block.attributes.ListFields():
        if field.name in COLUMNS:
            data[field.name] = value
    origin = np.array([block.origin.x, block.origin.y, block.origin.z])
    if not np.isfinite(origin).all():
        raise bad_answer("the server sent a block of points whose origin is not finite")
    columns: dict[str, Any] = {name: read_column(name, value, COLUMNS[name], block.count) for name, value in data.items()}
    if (columns["radii"] < 0).any():
        raise bad_answer("the server sent radii below 0")
    for scalar in block.attributes.scalars:
        if SCALAR + scalar.name in columns:
            raise bad_answer(f"the server sent two columns of the name {scalar.name}")
        columns[SCALAR + scalar.name] = read_column(scalar.name, scalar.values, ("<f4", 1), block.count, finite=False)
    return points_of(origin, columns)


def _decode_draco(draco: v1.DracoPoints, count: int) -> dict[str, bytes]:
    if _decode is None:
        raise bad_answer("the server sent Draco points that nobody asked for")
    try:
        positions, normals, radii, colours = _decode(draco.data, draco.radius_min, draco.radius_max, count)
    except ValueError as error:
        raise bad_answer(f"the server sent a bad block of points: {error}") from None
    columns = {"positions": positions, "normals": normals, "radii": radii}
    return columns | {"colours": colours} if colours else columns
