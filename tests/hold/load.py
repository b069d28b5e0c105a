"""Many streams of views at a modest rate, on one event loop, which decodes no points: frames name their points by a digest.

What the loop itself adds to the times is measured too: see Load.lateness.
"""

from __future__ import annotations

import asyncio
import dataclasses
import itertools
from collections.abc import AsyncIterator, Callable
from typing import Any

from grpc import aio

from curvecast.errors import error_of
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.calls import OPTIONS, Who, key_of, request_key
from hold.history import History, now
from hold.servers import Target

FRAME_SECONDS = 300.0  # beyond which a frame is missing, on any machine
HEARTBEAT = 0.02  # seconds

END: Any = aio.EOF  # type: ignore[attr-defined]  # the stubs lack it

NextView = Callable[[int], v1.SampleRequest]  # from its number


@dataclasses.dataclass
class Load:
    """What the streams together have seen."""

    history: History
    views: int = 0
    errors: list[str] = dataclasses.field(default_factory=list)
    refused: int = 0  # views, for want of room
    overtaken: int = 0
    seconds: list[tuple[float, float]] = dataclasses.field(default_factory=list)  # of each view: when sent, until its first frame
    lateness: list[float] = dataclasses.field(default_factory=list)  # of the event loop, which times include

    def between(self, begin: float, end: float) -> list[float]:
        """Seconds of the views that were sent in that time."""
        return [took for sent, took in self.seconds if begin <= sent < end]


def open_aio(server: Target) -> aio.Channel:
    return aio.insecure_channel(server.address, OPTIONS)


async def heartbeat(load: Load) -> None:
    """Measures how late the loop is, until it is cancelled."""
    while True:
        due = now() + HEARTBEAT
        await asyncio.sleep(HEARTBEAT)
        load.lateness.append(now() - due)


class StreamOfViews:
    """One client that sends a view, waits for its frame, acknowledges it, and goes on at a fixed rate."""

    def __init__(self, load: Load, server: Target, channel: aio.Channel, session: str, name: str, who: Who) -> None:
        self._load, self._server, self._session, self._name, self._who = load, server, session, name, who
        self._call = v1_grpc.CurvecastServiceStub(channel).StreamViews(metadata=(*who.metadata, *key_of(session)))
        self._opened = now()

    async def run(self, next_view: NextView, interval: float, is_over: Callable[[], bool], offset: float) -> None:
        """`interval`: seconds between views; `offset`: before the first one."""

        async def views() -> AsyncIterator[v1.SampleRequest]:
            await asyncio.sleep(offset)
            due = now()
            for sequence in itertools.count(1):
                if is_over():
                    return
                yield next_view(sequence)
                due = max(due + interval, now())
                await asyncio.sleep(due - now())

        await self.ask(views())

    async def ask(self, views: AsyncIterator[v1.SampleRequest]) -> None:
        """Asks for one view after the other, and ends the stream."""
        try:
            await self._call.write(v1.StreamViewsRequest(open=v1.OpenView(session_id=self._session, accept_deltas=True)))
            sequence = 0
            async for view in views:
                sequence += 1
                await self._view(sequence, view)
            await self._call.done_writing()
            while await self._call.read() is not END:
                continue
        except asyncio.TimeoutError:
            self._fail("DEADLINE_EXCEEDED", "no frame came")
        except (aio.AioRpcError, asyncio.InvalidStateError, EOFError):
            self._fail((await self._call.code()).name, await self._call.details())

    async def _view(self, sequence: int, sample: v1.SampleRequest) -> None:
        sent = now()
        await self._call.write(v1.StreamViewsRequest(view=v1.ViewUpdate(sequence=sequence, sample=sample)))
        is_first, is_final = True, False
        while not is_final:
            message = await asyncio.wait_for(self._call.read(), FRAME_SECONDS)
            if message is END:
                raise EOFError
            frame = message.frame
            if is_first:
                self._load.seconds.append((sent, now() - sent))
            is_first, is_final = False, not frame.statistics.refining
            self._tell(frame, sent, sample)
            await self._call.write(v1.StreamViewsRequest(ack=v1.FrameAck(sequence=frame.sequence)))
        self._load.views += 1

    def _tell(self, frame: v1.PointFrame, sent: float, sample: v1.SampleRequest) -> None:
        fields: dict[str, Any] = {}
        code = "OK"
        if frame.HasField("error"):
            code = error_of(frame.error.code, frame.error.message).code.name
            fields["message"] = frame.error.message
            if code == "RESOURCE_EXHAUSTED":
                self._load.refused += 1
            self._load.errors.append(f"{self._name}: {code}: {frame.error.message}")
        elif frame.digest:
            fields |= {"digest": f"{frame.digest:016x}", "points": frame.held_points}
        self._load.history.tell(
            "call",
            server=self._server.name,
            client=self._name,
            caller=self._who.name,
            call="StreamViews",
            session=self._session,
            begin=sent,
            end=now(),
            opened=self._opened,
            code=code,
            request=request_key(sample),
            vertices=frame.statistics.curve_vertices,
            settled=not frame.statistics.refining and frame.statistics.limit == v1.POINT_LIMIT_UNSPECIFIED,
            **fields,
        )

    def _fail(self, code: str, message: str) -> None:
        self._load.errors.append(f"{self._name}: {code}: {message}")
        self._call.cancel()
        self._load.history.tell(
            "call",
            server=self._server.name,
            client=self._name,
            caller=self._who.name,
            call="StreamViews",
            session=self._session,
            begin=self._opened,
            end=now(),
            code=code,
            message=message,
        )
