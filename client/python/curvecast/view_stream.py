# SPDX-License-Identifier: Apache-2.0
"""A conversation with a session: views go to the server, frames come back."""

from __future__ import annotations

import collections
import dataclasses
import threading
from collections.abc import Iterator

import grpc

from curvecast.connection import Connection
from curvecast.errors import Error, error_of_call
from curvecast.frame import Frame, decode_frame
from curvecast.points import Points, decode_blocks
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import View

MAX_REMEMBERED = 256  # views sent: a stream cannot resume from the frame of an older view
MAX_QUEUED = 16  # frames: the server keeps two in flight; the others are refused views, which are small


@dataclasses.dataclass(frozen=True, eq=False)
class HeldFrame:
    """The last frame of a stream, from which the next stream can go on."""

    points: Points  #: the whole list after the frame
    sample: v1.SampleRequest  #: the view that the frame answered
    digest: int  #: the server's digest of the points


class ViewStream:
    """Exchanges views and frames with the server. Session.stream() opens it; `with` ends it. One thread may send views while
    another waits for frames."""

    def __init__(
        self, connection: Connection, session_id: str, deltas: bool = True, first_bytes: int = 0, held: HeldFrame | None = None
    ) -> None:
        open_view = v1.OpenView(session_id=session_id, accept_deltas=deltas)
        if held is not None:
            open_view.held.CopyFrom(v1.HeldPoints(sample=held.sample, points=len(held.points), digest=held.digest))
        self._first_bytes = first_bytes
        self._changed = threading.Condition()
        # _changed guards all that follows but _points and _resumable, which belong to the thread that waits for frames.
        self._outgoing = collections.deque([v1.StreamViewsRequest(open=open_view)])
        self._sent: collections.deque[v1.ViewUpdate] = collections.deque(maxlen=MAX_REMEMBERED)
        self._view: v1.ViewUpdate | None = None  # the newest view, not sent yet
        self._sequence = 0
        self._needs_key = False
        self._writing = True
        self._queue: collections.deque[v1.PointFrame] = collections.deque()
        self._ended: Error | None = None
        self._points: Points | None = decode_blocks([]) if held is None else held.points  # None: a frame could not be decoded
        self._resumable = held  # the last frame decoded, if the next stream can go on from it
        self._call = connection.stub.StreamViews(self._requests(), metadata=connection.metadata(open_view))
        self._reader = threading.Thread(target=self._read, name="curvecast frames", daemon=True)
        self._reader.start()

    def __enter__(self) -> ViewStream:
        return self

    def __exit__(self, *_: object) -> None:
        self.cancel()

    def send(self, view: View, key_frame: bool = False) -> int:
        """Asks for a view and returns its number. The newest view wins: a view that is overtaken gets no frame. `key_frame`: the
        frame must not be a delta. Error: FAILED_PRECONDITION after close(); after the stream's end, what the stream ended with."""
        request = view.to_proto(in_stream=True)
        with self._changed:
            if self._ended is not None:
                raise self._ended
            if not self._writing:
                raise Error(grpc.StatusCode.FAILED_PRECONDITION, "the stream is closed")
            self._sequence += 1
            overtaken_key = self._view is not None and self._view.key_frame
            self._view = v1.ViewUpdate(
                sequence=self._sequence,
                sample=request,
                key_frame=key_frame or overtaken_key or self._needs_key,
                first_bytes=self._first_bytes,
            )
            self._sent.append(self._view)
            self._needs_key = False
            self._changed.notify_all()
            return self._sequence

    def frame(self, timeout: float | None = None) -> Frame:
        """Waits for the next frame, decodes it and acknowledges it. Error: DEADLINE_EXCEEDED after `timeout` seconds; DATA_LOSS for
        a frame that breaks the protocol, after which the next view asks for a key frame; ABORTED when the server has ended the
        stream in order, else what the stream ended with."""
        with self._changed:
            if not self._changed.wait_for(lambda: self._queue or self._ended is not None, timeout):
                raise Error(grpc.StatusCode.DEADLINE_EXCEEDED, f"no frame within {timeout} s")
            if not self._queue:
                assert self._ended is not None
                raise self._ended
            message = self._queue.popleft()
            self._changed.notify_all()
        try:
            return self._decode(message)
        except Error as error:
            self._points = self._resumable = None
            with self._changed:
                self._needs_key = True
            raise Error(error.code, f"frame {message.sequence}: {error.message}") from None
        finally:
            with self._changed:
                self._outgoing.append(v1.StreamViewsRequest(ack=v1.FrameAck(sequence=message.sequence)))
                self._changed.notify_all()

    def held(self) -> HeldFrame | None:
        """Returns the last frame that came, for Session.stream(held=...); None where the server gave it no digest."""
        return self._resumable

    def close(self) -> None:
        """Sends no more views and waits for the server to end the stream. Drops frames that frame() has not returned. Error: what
        the stream ended with, unless the server ended it in order."""
        with self._changed:
            self._writing = False
            self._changed.notify_all()
            while self._ended is None:
                self._queue.clear()
                self._changed.notify_all()
                self._changed.wait()
            self._queue.clear()
            if self._ended.code is not grpc.StatusCode.ABORTED:
                raise self._ended

    def cancel(self) -> None:
        """Ends the stream at once. frame() then raises CANCELLED in a thread that waits in it."""
        self._call.cancel()
        with self._changed:
            self._writing = False
            self._queue.clear()
            self._changed.notify_all()
        self._reader.join()

    def _requests(self) -> Iterator[v1.StreamViewsRequest]:
        """Yields what gRPC sends, on a thread of gRPC: acknowledgements first, then the newest view."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._outgoing or self._view is not None or not self._writing)
                if self._outgoing:
                    request = self._outgoing.popleft()
                elif self._view is not None:
                    request, self._view = v1.StreamViewsRequest(view=self._view), None
                else:
                    return
            yield request

    def _read(self) -> None:
        """Queues the frames that come, on the thread of this stream, until the stream ends."""
        ended = Error(grpc.StatusCode.ABORTED, "the stream has ended")
        try:
            for response in self._call:
                with self._changed:
                    self._changed.wait_for(lambda: len(self._queue) < MAX_QUEUED or not self._call.is_active())
                    self._queue.append(response.frame)
                    self._changed.notify_all()
        except grpc.RpcError as error:
            ended = error_of_call(error)
        with self._changed:
            self._ended = ended
            self._writing = False
            self._changed.notify_all()

    def _decode(self, message: v1.PointFrame) -> Frame:
        """Applies a frame to the list of points, and remembers what the next stream can go on from. Error DATA_LOSS: the frame
        breaks the protocol."""
        frame = decode_frame(message, self._points)
        if frame.error is not None:
            return frame
        assert frame.points is not None
        self._points = points = frame.points
        with self._changed:
            while self._sent and self._sent[0].sequence < message.sequence:
                self._sent.popleft()
            remembered = self._sent[0] if self._sent and self._sent[0].sequence == message.sequence else None
        self._resumable = HeldFrame(points, remembered.sample, message.digest) if remembered and message.digest else None
        return frame
