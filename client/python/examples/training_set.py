# SPDX-License-Identifier: Apache-2.0
"""Many point sets of a mesh as training data, each with another seed and from another side, in one array:
training_set.py ADDRESS MESH SETS POINTS OUT.npz"""

import sys

import numpy as np

import curvecast

address, mesh_path, sets_text, count_text, out_path = sys.argv[1:]
sets, count = int(sets_text), int(count_text)
random = np.random.default_rng(seed=0)

positions = np.empty((sets, count, 3), np.float32)
normals = np.empty((sets, count, 3), np.float32)
curvatures = np.empty((sets, count, 2), np.float32)

with curvecast.connect(address) as client:
    session = client.open(client.upload(mesh_path), points=count)
    for i in range(sets):
        # Denser on one side, as a scanner sees it; the other side stays.
        x, y, z = random.normal(size=3)
        side = curvecast.density.expression(f"1.2 + ({x} * nx + {y} * ny + {z} * nz) / {np.hypot(np.hypot(x, y), z)}")
        points = session.sample(count, density=[side], seed=i, attributes=["curvatures"])
        positions[i], normals[i], curvatures[i] = points.positions, points.normals, points.curvatures
    origin = points.origin

np.savez(out_path, origin=origin, positions=positions, normals=normals, curvatures=curvatures)
print(f"{sets} sets of {count} points in {out_path}")
