"""A prepared mesh on a server, from which points are taken."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator
from typing import Any

from curvecast.connection import Connection
from curvecast.curve import Curve, decode_curve
from curvecast.errors import bad_answer
from curvecast.points import Points, decode_blocks
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import View
from curvecast.view_stream import HeldFrame, ViewStream

POLL = 0.02  # seconds between questions whether a curve is finer now
ROUNDS = 4  # a density may find the finer curve too coarse again


class Session:
    """A session as the server described it last: see `info`. It is shared by all clients with the same mesh and options, and
    stays on the server until close()."""

    def __init__(self, connection: Connection, info: v1.Session) -> None:
        self._connection = connection
        self.info = info  #: curvecast.v1.Session: options, curve_revision, refining, and a report: mesh, times, distortion

    @property
    def id(self) -> str:
        return self.info.session_id

    def __repr__(self) -> str:
        return f"<curvecast.Session {self.id}>"

    def refresh(self) -> v1.Session:
        """Asks the server anew and returns `info`."""
        request = v1.GetSessionRequest(session_id=self.id)
        self.info = self._connection.ask("GetSession", request, self._connection.short_timeout).session
        return self.info

    def sample(self, view: View | int | None = None, *, patience: float = 0, **options: Any) -> Points:
        """One point set: sample(view), or the fields of a View as arguments: sample(50_000, camera=..., density=[...]).

        Where the curve is too coarse for it, points.statistics.refining is set and the server makes a finer one; `patience`: so
        many seconds this waits for it, and asks again.
        """
        if not isinstance(view, View):
            view = View(points=view, **options)
        elif options:
            view = dataclasses.replace(view, **options)
        request = v1.ResampleRequest(session_id=self.id, sample=view.to_proto())
        deadline = time.monotonic() + patience
        points = self._sample_once(request)
        for _ in range(ROUNDS if patience > 0 else 0):
            if not points.statistics.refining:
                break
            while self.refresh().refining:
                if time.monotonic() >= deadline:
                    return points
                time.sleep(POLL)
            points = self._sample_once(request)
        return points

    def stream(self, deltas: bool = True, first_bytes: int = 0, held: HeldFrame | None = None) -> ViewStream:
        """A conversation: views out, frames in.

        deltas: frames may be differences to the one before, taken in by themselves. first_bytes: with them, larger frames come in
        parts, one of about so many bytes first, statistics.refining set; 0 = whole. held: the same of a stream of this session
        that broke off, to go on from there.
        """
        return ViewStream(self._connection, self.id, deltas, first_bytes, held)

    def curve(self) -> Curve:
        """The curve itself: all of its vertices, in order."""
        request = v1.GetCurveRequest(session_id=self.id)
        return self._connection.ask_all("GetCurve", request, self._connection.long_timeout, decode_curve)

    def update(self, pinned: bool | None = None, time_to_live: float | None = None) -> v1.Session:
        """Pins the session in the server's memory, or has it forgotten after so many seconds without use (0 = never). None: as it
        is. Returns `info`."""
        request = v1.UpdateSessionRequest(session_id=self.id)
        if pinned is not None:
            request.pinned = pinned
        if time_to_live is not None:
            request.time_to_live = time_to_live
        self.info = self._connection.ask("UpdateSession", request, self._connection.short_timeout).session
        return self.info

    def close(self) -> None:
        """Has the server forget the session, in memory and in its cache, for all clients."""
        self._connection.call("CloseSession", v1.CloseSessionRequest(session_id=self.id), self._connection.short_timeout)

    def _sample_once(self, request: v1.ResampleRequest) -> Points:
        sample = request.sample
        most = sample.points if sample.WhichOneof("budget") == "points" else MAX_POINTS
        statistics = v1.FrameStatistics()

        def blocks(messages: Iterator[v1.ResampleResponse]) -> Iterator[v1.PointBlock]:
            count = 0
            for message in messages:
                count += message.points.count
                if count > most:  # a server that sends on and on must not fill this machine's memory
                    raise bad_answer(f"the server sent more than the {most} points asked for")
                if message.HasField("statistics"):
                    statistics.CopyFrom(message.statistics)
                if message.HasField("points"):
                    yield message.points
            if count == 0:
                raise bad_answer("the server sent no points")

        points = self._connection.ask_all(
            "Resample", request, self._connection.long_timeout, lambda messages: decode_blocks(blocks(messages))
        )
        may_be_fewer = sample.sampler == v1.SAMPLER_PROGRESSIVE or any(getattr(t.distance, "global") for t in sample.density)
        if sample.WhichOneof("budget") == "points" and len(points) < most and not may_be_fewer:
            raise bad_answer(f"asked for {most} points, but the server sent {len(points)}")
        return dataclasses.replace(points, statistics=statistics)
