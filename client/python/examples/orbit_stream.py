# SPDX-License-Identifier: Apache-2.0
"""Streams views of a camera that goes round a mesh and prints what each frame took: orbit_stream.py ADDRESS MESH FRAMES POINTS"""

import math
import sys

import numpy as np

import curvecast

address, mesh_path, frames, count = sys.argv[1:]

with curvecast.connect(address) as client:
    session = client.open(client.upload(mesh_path), points=int(count))
    box = session.info.report.mesh
    low, high = (np.array([corner.x, corner.y, corner.z]) for corner in (box.box_min, box.box_max))
    centre, reach = 0.5 * (low + high), 1.5 * float(np.linalg.norm(high - low))
    print("frame   kind  points  added removed  bytes  server ms  decode ms")
    with session.stream() as stream:
        for i in range(int(frames)):
            angle = math.radians(i)
            eye = centre + reach * np.array([math.sin(angle), 0.2, math.cos(angle)])
            stream.send(
                curvecast.View(points=int(count), density=[curvecast.density.view(s0=0.2)], camera=curvecast.Camera(eye, centre))
            )
            frame = stream.frame(timeout=60)
            if frame.error:
                raise frame.error
            took = frame.statistics
            server = 1000 * (took.density_seconds + took.equalise_seconds + took.encode_seconds)
            kind = "delta" if frame.is_delta else "key"
            counts = f"{frame.sequence:5}  {kind:>5}  {len(frame.points or ()):6}  {frame.added:5}  {frame.removed:6}"
            print(f"{counts}  {frame.encoded_bytes:6}  {server:8.1f}  {1000 * frame.decode_seconds:9.1f}")
