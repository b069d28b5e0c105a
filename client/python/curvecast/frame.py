# SPDX-License-Identifier: Apache-2.0
"""The answer to a view, and how a message of the API becomes it."""

from __future__ import annotations

import dataclasses
import time

from curvecast.errors import Error, bad_answer, error_of
from curvecast.point_edits import apply_edits
from curvecast.points import Points, decode_blocks, encoded_bytes
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """The answer to a view."""

    sequence: int  #: number of the view; the same again when an improved frame follows by itself
    curve_revision: int
    points: Points | None  #: the whole list after this frame, read-only; with an error the list of the frame before
    is_delta: bool  #: the frame changed the points of the frame before
    added: int  #: number of points that came with the frame; a key frame adds all
    removed: int  #: number of points that went with the frame; a key frame removes all
    resized: int  #: number of steps of discs from one radius to the next
    statistics: v1.FrameStatistics  #: the server's times, and .refining: a better frame follows
    encoded_bytes: int  #: bytes of the points and edits on the wire
    decode_seconds: float  #: time that decoding took, seconds
    error: Error | None = None  #: why the server refused the view; the stream goes on


def decode_frame(message: v1.PointFrame, before: Points | None) -> Frame:
    """Applies a frame to the points of the frame before; None: these could not be decoded. Error DATA_LOSS: the frame breaks the
    protocol."""
    start = time.perf_counter()
    edits = message.edits
    if message.HasField("error"):
        refused = error_of(message.error.code, message.error.message, message.error.retry_after or None)
        return Frame(message.sequence, message.curve_revision, before, False, 0, 0, 0, message.statistics, 0, 0, refused)
    blocks = message.points
    count = sum(block.count for block in blocks)
    if count > MAX_POINTS:
        raise bad_answer(f"it holds {count} points")
    points = decode_blocks(blocks)
    is_delta = message.kind == v1.FRAME_KIND_DELTA
    if is_delta:
        if before is None:
            raise bad_answer("a delta to points that are not there")
        points = apply_edits(before, edits, points)
    elif message.kind != v1.FRAME_KIND_KEY:
        raise bad_answer(f"kind {message.kind} is not known")
    if len(points) != message.held_points:
        raise bad_answer(f"there are {len(points)} points after it, not {message.held_points}")
    for column in points.columns().values():  # the next delta builds on them
        column.flags.writeable = False
    return Frame(
        sequence=message.sequence,
        curve_revision=message.curve_revision,
        points=dataclasses.replace(points, statistics=message.statistics),
        is_delta=is_delta,
        added=len(edits.added) if is_delta else len(points),
        removed=len(edits.removed) if is_delta else len(before or ()),
        resized=len(edits.resized),
        statistics=message.statistics,
        encoded_bytes=sum(map(encoded_bytes, blocks)) + (edits.ByteSize() if is_delta else 0),
        decode_seconds=time.perf_counter() - start,
    )
