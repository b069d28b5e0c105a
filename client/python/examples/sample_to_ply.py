# SPDX-License-Identifier: Apache-2.0
"""Samples a mesh into a PLY file, with normals, radii and colours: sample_to_ply.py ADDRESS MESH POINTS OUT.ply"""

import sys
from typing import Any

import numpy as np

import curvecast

address, mesh_path, count, out_path = sys.argv[1:]


def show(stage: str, fraction: float) -> None:
    print(f"\r{stage:>12} {fraction:4.0%}", end="", file=sys.stderr)


with curvecast.connect(address) as client:
    mesh = client.upload(mesh_path, on_progress=show)
    session = client.open(mesh, points=int(count), on_progress=show)
    points = session.sample(int(count), density=[curvecast.density.curvature(floor=0.2)])

columns: list[tuple[str, Any, str]] = [
    ("x y z", points.world_positions(), "f4"),
    ("nx ny nz", points.normals, "f4"),
    ("radius", points.radii, "f4"),
]
if points.colours is not None:
    columns.append(("red green blue", points.colours, "u1"))
rows = np.empty(len(points), [(name, kind) for names, _, kind in columns for name in names.split()])
for names, values, _ in columns:
    for name, column in zip(names.split(), values.reshape(len(points), -1).T, strict=True):
        rows[name] = column
types = {"f4": "float", "u1": "uchar"}
with open(out_path, "wb") as file:
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property {types[kind]} {name}" for names, _, kind in columns for name in names.split()]
    file.write(("\n".join(header) + "\nend_header\n").encode())
    rows.tofile(file)
print(f"\n{len(points)} points in {out_path}")
