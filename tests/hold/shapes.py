"""Meshes from generators, and views of them."""

from __future__ import annotations

import math

import numpy as np

from curvecast import Camera, View, density
from curvecast.v1 import curvecast_pb2 as v1

TETRAHEDRON = b"OFF\n4 4 0\n1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n"


def bumpy_ball(rings: int, seed: int = 0) -> bytes:
    """A ball of 4 rings (rings - 1) triangles whose radius goes up and down, as an OFF file; each seed another one."""
    columns = 2 * rings
    points, faces = [(0.0, 1.0, 0.0)], []
    for ring in range(1, rings):
        theta = math.pi * ring / rings
        for column in range(columns):
            phi = 2 * math.pi * column / columns
            radius = 1 + 0.1 * math.sin(3 * phi + seed) * math.sin(theta) ** 2
            points.append(
                (radius * math.sin(theta) * math.cos(phi), radius * math.cos(theta), radius * math.sin(theta) * math.sin(phi))
            )
    points.append((0.0, -1.0, 0.0))
    for column in range(columns):
        after = (column + 1) % columns
        faces.append((0, 1 + after, 1 + column))
        faces.append((len(points) - 1, len(points) - 1 - columns + column, len(points) - 1 - columns + after))
        for ring in range(rings - 2):
            a, b = 1 + ring * columns + column, 1 + ring * columns + after
            faces += [(a, b, b + columns), (a, b + columns, a + columns)]
    lines = [f"OFF\n{len(points)} {len(faces)} 0", *(f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in points)]
    return ("\n".join([*lines, *(f"3 {a} {b} {c}" for a, b, c in faces)]) + "\n").encode()


def relief_stl(megabytes: float, seed: int) -> bytes:
    """A relief of about so many millions of bytes, 50 for each triangle, as a binary STL file."""
    side = max(1, round(math.sqrt(megabytes * 1e6 / 100)))
    at = np.arange(side + 1, dtype=np.float32) / side
    x, y = np.meshgrid(at, at, indexing="ij")
    z = 0.05 * np.sin(9 * x + seed) * np.cos(7 * y)
    points = np.stack([x, y, z.astype(np.float32)], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    triangles = np.concatenate([np.stack(corners, axis=2).reshape(-1, 9) for corners in ((a, b, c), (a, c, d))])
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", 9), ("rest", "<u2")])
    records["corners"] = triangles
    return bytes(80) + len(triangles).to_bytes(4, "little") + records.tobytes()


def orbit_view(points: int, degrees: float, encoding: str = "draco") -> v1.SampleRequest:
    """Silhouettes, seen from a circle about the y axis, by the progressive sampler: what a viewer asks for."""
    angle = math.radians(degrees)
    camera = Camera((4 * math.sin(angle), 0.5, 4 * math.cos(angle)))
    view = View(points, density=density.view(0.1), camera=camera, sampler="progressive", encoding=encoding)
    return view.to_proto(in_stream=True)


def plain_view(points: int, seed: int = 0) -> v1.SampleRequest:
    """Evenly spread points of the equalised sampler as they are computed, with all that comes from the surface."""
    return View(points, seed=seed, sampler="equalised", attributes=("curvatures", "surface", "directions")).to_proto()
