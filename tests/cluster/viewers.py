"""Viewers who look at sessions at a steady rate, and go on with what they hold over another stream when one breaks."""

from __future__ import annotations

import asyncio
import bisect
import dataclasses
import itertools
import random
from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple

from cluster.line import BrokenError, Line, is_passing
from curvecast.errors import error_of
from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import request_key
from hold.history import History, now
from hold.load import NextView
from hold.servers import Target

FIRST_DELAY, LONGEST_DELAY = 0.1, 2.0  # seconds between streams, as of our clients


class Break(NamedTuple):
    at: float
    viewer: Viewer
    replica: str
    error: BrokenError


@dataclasses.dataclass
class Crowd:
    """What all viewers together have seen."""

    history: History
    views: int = 0
    failed: list[str] = dataclasses.field(default_factory=list)  # views that got an error
    breaks: list[Break] = dataclasses.field(default_factory=list)
    # Of a view: since when a viewer had waited for points of it, and how long.
    seconds: list[tuple[float, float]] = dataclasses.field(default_factory=list)

    def longest(self, begin: float, end: float) -> float:
        """Seconds that somebody waited, at any moment of that time."""
        return max((took for since, took in self.seconds if since < end and since + took >= begin), default=0.0)


class Viewer:
    def __init__(self, crowd: Crowd, target: Target, session: str, name: str, open_line: Callable[[], Awaitable[Line]]) -> None:
        self.replica = ""  # that its stream is with, once it has had a frame
        self.arrivals: list[tuple[float, float]] = []  # of each view's first frame: when, and when its stream was opened
        self._crowd, self._target, self._session, self._name = crowd, target, session, name
        self._open = open_line
        self._line: Line | None = None
        self._opened = 0.0
        self._sequence = 0  # of the last view of this stream
        self._held: v1.HeldPoints | None = None
        self._waits_since = 0.0

    def arrival_after(self, at: float) -> float:
        """When the first frame came over a stream that was opened after that; infinite: none has."""
        first = bisect.bisect_left(self.arrivals, (at, 0.0))
        return next((came for came, opened in self.arrivals[first:] if opened >= at), float("inf"))

    async def run(self, next_view: NextView, interval: float, is_over: Callable[[], bool], offset: float = 0) -> None:
        """`interval`: seconds between views; `offset`: before the first one."""
        due = now() + offset
        for number in itertools.count():
            await asyncio.sleep(due - now())
            if is_over():
                break
            await self.look(next_view(number))
            due = max(due + interval, now())
        await self._hang_up()

    async def look(self, sample: v1.SampleRequest) -> None:
        """Asks for a view until its last frame is there, over as many streams as it takes."""
        begin, delay = now(), FIRST_DELAY
        self._waits_since = begin
        while True:
            frames = len(self.arrivals)
            error = await self._try(sample, begin)
            if error is None:
                return
            if len(self.arrivals) > frames:  # it had points, though not the last of them
                self._waits_since = now()
            self._tell(sample, begin, error.code, message=error.message)
            self._crowd.breaks.append(Break(now(), self, self.replica, error))
            await self._hang_up()
            if not is_passing(error.code, error.message):
                self._crowd.failed.append(f"{self._name}: {error}")
                return
            await asyncio.sleep(delay * random.uniform(0.5, 1))
            delay = min(2 * delay, LONGEST_DELAY)

    async def _try(self, sample: v1.SampleRequest, begin: float) -> BrokenError | None:
        try:
            await self._ask(sample, begin)
        except BrokenError as error:
            return error
        return None

    async def _ask(self, sample: v1.SampleRequest, begin: float) -> None:
        line = self._line or await self._begin()
        self._sequence += 1
        await line.send(v1.StreamViewsRequest(view=v1.ViewUpdate(sequence=self._sequence, sample=sample)))
        is_first, is_final = True, False
        while not is_final:
            frame = await line.receive()
            if is_first:
                self._crowd.seconds.append((self._waits_since, now() - self._waits_since))
                self.arrivals.append((now(), self._opened))
                self.replica = line.replica
            is_first, is_final = False, not frame.statistics.refining
            self._take(frame, sample, begin)
            await line.send(v1.StreamViewsRequest(ack=v1.FrameAck(sequence=frame.sequence)))
        self._crowd.views += 1

    async def _begin(self) -> Line:
        self._opened = now()
        self._line = await self._open()
        self._sequence = 0
        opening = v1.OpenView(session_id=self._session, accept_deltas=True)
        if self._held is not None:
            opening.held.CopyFrom(self._held)
        await self._line.send(v1.StreamViewsRequest(open=opening))
        return self._line

    async def _hang_up(self) -> None:
        line, self._line, self.replica = self._line, None, ""
        if line is not None:
            await line.close()

    def _take(self, frame: v1.PointFrame, sample: v1.SampleRequest, begin: float) -> None:
        if frame.HasField("error"):
            code = error_of(frame.error.code, frame.error.message).code.name
            self._crowd.failed.append(f"{self._name}: {code}: {frame.error.message}")
            self._tell(sample, begin, code, message=frame.error.message)
            return
        self._held = v1.HeldPoints(sample=sample, points=frame.held_points, digest=frame.digest) if frame.digest else None
        self._tell(
            sample,
            begin,
            "OK",
            **({"digest": f"{frame.digest:016x}"} if frame.digest else {}),
            vertices=frame.statistics.curve_vertices,
            settled=not frame.statistics.refining and frame.statistics.limit == v1.POINT_LIMIT_UNSPECIFIED,
            replica=self.replica,
        )

    def _tell(self, sample: v1.SampleRequest, begin: float, code: str, **fields: Any) -> None:
        self._crowd.history.tell(
            "call",
            server=self._target.name,
            client=self._name,
            caller="",
            call="StreamViews",
            session=self._session,
            begin=begin,
            end=now(),
            code=code,
            request=request_key(sample),
            **fields,
        )
