# SPDX-License-Identifier: Apache-2.0
"""Numbers that servers and clients agree on: those of the table at the top of curvecast.proto that this client needs."""

MAX_POINTS = 4_000_000  # points of one point set, or of a frame's list
MAX_NEIGHBOUR_PAIRS = 64_000_000  # neighbours of all points of one call
MAX_COMPANIONS = 256  # files that one mesh refers to
MAX_CHUNK_BYTES = 1 << 20  # bytes of one chunk of an upload
MAX_FRAME_BYTES = 32 << 20  # bytes of the points of a frame, or of a picture
RADIUS_RUNGS = 64  # of the ladder of radii: see PointEdits.radius_max
RADIUS_RUNGS_PER_OCTAVE = 2  # from one radius to half of it
MAX_CURVE_LEVEL = 30  # deepest level of a quad of the curve
