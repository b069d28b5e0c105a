# SPDX-License-Identifier: Apache-2.0
"""One connection to a server: calls with time limits and retries."""

from __future__ import annotations

import queue
import random
import time
from collections.abc import Callable, Iterator
from typing import Any, BinaryIO, TypeVar

import grpc

from curvecast.errors import Error, bad_answer, translate_errors
from curvecast.notebook import viewer_address
from curvecast.protocol import MAX_CHUNK_BYTES, MAX_FRAME_BYTES
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc

T = TypeVar("T")
OnProgress = Callable[[str, float], None]

CHUNK_BYTES = MAX_CHUNK_BYTES // 2  # of an upload
ROUTING_KEY, ROUTING_KEY_DIGITS = "curvecast-key", 16  # nobody has to look at it: every server can answer every call
FIRST_DELAY, LONGEST_DELAY = 0.1, 2.0  # seconds between attempts; doubles, with jitter
CHANNEL_OPTIONS = [
    ("grpc.max_receive_message_length", 2 * MAX_FRAME_BYTES),  # frames have more than their points
    ("grpc.keepalive_time_ms", 20_000),  # between pings during a call; servers allow one every 5 seconds
    ("grpc.keepalive_timeout_ms", 10_000),  # until a silent server counts as lost
    ("grpc.initial_reconnect_backoff_ms", int(1000 * FIRST_DELAY)),
    ("grpc.min_reconnect_backoff_ms", int(1000 * FIRST_DELAY)),
    ("grpc.max_reconnect_backoff_ms", int(1000 * LONGEST_DELAY)),
]


class Connection:
    """Makes the calls of one client. Thread-safe. All but call_once() are repeated when the line or the server was lost meanwhile:
    those calls are idempotent."""

    def __init__(
        self,
        address: str,
        credentials: grpc.ChannelCredentials | None,
        token: str,
        short_timeout: float,
        long_timeout: float,
        attempts: int,
        viewer: str = "",
    ) -> None:
        self.viewer = viewer_address(viewer)
        if attempts < 1:
            raise ValueError(f"attempts is {attempts}; there has to be one")
        self.short_timeout, self.long_timeout, self._attempts = short_timeout, long_timeout, attempts
        if credentials is None:
            self._channel = grpc.insecure_channel(address, CHANNEL_OPTIONS)
        else:
            self._channel = grpc.secure_channel(address, credentials, CHANNEL_OPTIONS)
        self._token = token
        self.stub = v1_grpc.CurvecastServiceStub(self._channel)

    @property
    def has_token(self) -> bool:
        return self._token != ""

    def close(self) -> None:
        self._channel.close()

    def metadata(self, about: Any) -> tuple[tuple[str, str], ...]:
        """Returns what a call carries besides its messages. `about`: the request, or that which begins the call."""
        key = routing_key(about)
        return ((("authorization", f"Bearer {self._token}"),) if self._token else ()) + (((ROUTING_KEY, key),) if key else ())

    def call_once(self, method: str, request: Any, timeout: float | None) -> Any:
        """Makes a call with one answer, once. `timeout`: seconds, of the whole call; None: no limit."""
        with translate_errors():
            return getattr(self.stub, method)(request, timeout=timeout, metadata=self.metadata(request))

    def call(self, method: str, request: Any, timeout: float | None) -> Any:
        """Makes a call with one answer, and repeats it. `timeout`: as of call_once(), for each attempt."""
        return self._retrying(lambda: self.call_once(method, request, timeout))

    def read_stream(self, method: str, request: Any, timeout: float | None, take: Callable[[Iterator[Any]], T]) -> T:
        """Makes a call whose answer is many messages, gives their iterator to `take`, and returns what `take` returns. Cancels the
        call when `take` leaves early, by an exception too. A repeated call runs `take` again. `timeout`: as of call()."""

        def attempt() -> T:
            with translate_errors():
                messages = getattr(self.stub, method)(request, timeout=timeout, metadata=self.metadata(request))
                try:
                    return take(messages)
                finally:
                    messages.cancel()

        return self._retrying(attempt)

    def call_with_progress(self, method: str, request: Any, result: str, on_progress: OnProgress | None) -> Any:
        """Makes a call whose answer is messages of progress and then a result, and returns the field `result` of the last message.
        Has no time limit."""

        def take(messages: Iterator[Any]) -> Any:
            found = None
            for message in told(messages, on_progress):
                if message.HasField(result):
                    found = getattr(message, result)
            if found is None:
                raise bad_answer(f"the server ended {method} without its {result}")
            return found

        return self.read_stream(method, request, None, take)

    def upload(self, header: v1.UploadHeader, file: BinaryIO, on_progress: OnProgress | None) -> v1.UploadMeshResponse:
        """Sends the file that `header` describes, from where an earlier upload of the same file broke off."""
        return self._retrying(lambda: self._upload_once(header, file, on_progress))

    def _upload_once(self, header: v1.UploadHeader, file: BinaryIO, on_progress: OnProgress | None) -> v1.UploadMeshResponse:
        # gRPC takes messages out of `requests` on a thread of its own, which tells this one through the queue: bytes sent, an
        # error, or None at the end.
        events: queue.SimpleQueue[int | Exception | None] = queue.SimpleQueue()

        def requests() -> Iterator[v1.UploadMeshRequest]:
            yield v1.UploadMeshRequest(header=header)
            try:
                file.seek(header.offset)
                while chunk := file.read(CHUNK_BYTES):
                    yield v1.UploadMeshRequest(chunk=chunk)
                    events.put(len(chunk))
            except (OSError, ValueError) as error:  # ValueError: closed by a caller who has given up
                events.put(error)

        header.offset = self.call_once("GetUpload", v1.GetUploadRequest(mesh_id=header.mesh_id), self.short_timeout).received
        with translate_errors():
            future = self.stub.UploadMesh.future(requests(), timeout=self.long_timeout, metadata=self.metadata(header))
            try:
                future.add_done_callback(lambda _: events.put(None))
                sent = header.offset
                while (event := events.get()) is not None:
                    if isinstance(event, Exception):
                        raise event
                    sent += event
                    if on_progress is not None:
                        on_progress("upload", min(sent / header.size, 1.0))
                response: v1.UploadMeshResponse = future.result()
                return response
            finally:
                future.cancel()

    def _retrying(self, attempt: Callable[[], T]) -> T:
        delay = FIRST_DELAY
        for left in reversed(range(self._attempts)):
            try:
                return attempt()
            except Error as error:
                if left == 0 or not is_retryable(error):
                    raise
            time.sleep(delay * random.uniform(0.5, 1.0))  # many clients may have lost the same server
            delay = min(2 * delay, LONGEST_DELAY)
        raise AssertionError("unreachable")


def routing_key(about: Any) -> str:
    """Returns the first digits of the session or mesh that a request is about, for proxies in front of several servers: those of a
    session are those of its mesh. Empty where it is about none."""
    return str(getattr(about, "session_id", "") or getattr(about, "mesh_id", ""))[:ROUTING_KEY_DIGITS]


def told(messages: Iterator[Any], on_progress: OnProgress | None) -> Iterator[Any]:
    """Passes messages on, and tells of the progress that they hold."""
    for message in messages:
        if message.HasField("progress") and on_progress is not None:
            on_progress(message.progress.stage, message.progress.fraction)
        yield message


def is_retryable(error: Error) -> bool:
    """Tells whether a call was lost on its way. CANCELLED comes from a proxy that lost its server: this client never waits for a
    call that it has cancelled. UNKNOWN: the proxy lost it in the middle of an answer."""
    if error.code is grpc.StatusCode.INTERNAL:
        return "RST_STREAM" in error.message
    if error.code is grpc.StatusCode.UNKNOWN:
        return error.message in ("Stream removed", "No status received")
    return error.code in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED)
