# SPDX-License-Identifier: Apache-2.0
"""From a mesh to arrays, in this process, in ten lines: ten_lines.py MESH OUT.npz"""

import sys

import numpy as np

import curvecast
from curvecast import Camera, density

surface = curvecast.read(sys.argv[1])  # or curvecast.Surface(vertices, faces)
points = surface.sample(50_000, density=density.curvature(), seed=1, attributes=["curvatures", "surface"])
print(*(f"{name} {column.shape} {column.dtype}" for name, column in points.columns().items()), sep="\n")
even = surface.measure(points, density=[density.curvature()]).sets[0]
print(f"discrepancy {even.ball_discrepancy.rms_relative:.3f} of that of random points")
eyes = points.world_positions().mean(axis=0) + 3 * np.ptp(points.positions) * np.array([[0, 0.2, 1], [0.02, 0.2, 1]])
frames = [surface.view(Camera(eye), 50_000, density=density.picture()) for eye in eyes]
print(*(f"view: {len(frame.points or ())} points, {frame.added} came, {frame.removed} went" for frame in frames), sep="\n")
mesh = surface.remesh(5000)
np.savez(sys.argv[2], **points.columns(), vertices=mesh.vertices.positions, triangles=mesh.triangles)  # torch takes them, too
