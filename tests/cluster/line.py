"""One stream of views through the proxy, over gRPC or over a WebSocket."""

from __future__ import annotations

import asyncio
import concurrent.futures
from typing import Any, Protocol

import grpc
from grpc import aio

from cluster.edge import REPLICA
from curvecast.connection import ROUTING_KEY_DIGITS, is_retryable
from curvecast.errors import Error, error_of
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.calls import OPTIONS, key_of
from hold.load import END
from hold.web_socket import ClosedError, Ended, WebSocket

FRAME_SECONDS = 60.0  # beyond which a frame is missing, on any machine
# As our clients do; a connection that is being made gets more time, since the machine does other things too.
CHANNEL_OPTIONS = [*OPTIONS, ("grpc.initial_reconnect_backoff_ms", 100), ("grpc.max_reconnect_backoff_ms", 2000)]


def is_passing(code: str, message: str) -> bool:
    """Whether our clients make such a call again. code: the name of a gRPC status code."""
    return is_retryable(Error(grpc.StatusCode[code], message))


class BrokenError(Exception):
    """The stream has ended, or was not to be had. code: the name of a gRPC status code."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(f"{code}: {message}")
        self.code, self.message = code, message


class Line(Protocol):
    """Its methods raise BrokenError."""

    replica: str  # that answers; empty before the first frame

    async def send(self, request: v1.StreamViewsRequest) -> None: ...

    async def receive(self) -> v1.PointFrame: ...

    async def close(self) -> None: ...


class GrpcLine:
    def __init__(self, channel: aio.Channel, session: str) -> None:
        self.replica = ""
        self._call = v1_grpc.CurvecastServiceStub(channel).StreamViews(metadata=key_of(session))

    async def send(self, request: v1.StreamViewsRequest) -> None:
        try:
            await self._call.write(request)
        except (aio.AioRpcError, asyncio.InvalidStateError):
            raise await self._broken() from None

    async def receive(self) -> v1.PointFrame:
        try:
            message = await asyncio.wait_for(self._call.read(), FRAME_SECONDS)
            if message is END:
                raise await self._broken()
            if not self.replica:
                self.replica = next((str(value) for name, value in await self._call.initial_metadata() if name == REPLICA), "")
        except asyncio.TimeoutError:
            raise BrokenError("DEADLINE_EXCEEDED", "no frame came") from None
        except aio.AioRpcError:
            raise await self._broken() from None
        frame: v1.PointFrame = message.frame
        return frame

    async def close(self) -> None:
        self._call.cancel()

    async def _broken(self) -> BrokenError:
        return BrokenError((await self._call.code()).name, await self._call.details() or "")


class WebSocketLine:
    """Made by open_web_socket()."""

    def __init__(self, socket: WebSocket, threads: concurrent.futures.Executor) -> None:
        self.replica = str(socket.headers.get(REPLICA, ""))
        self._socket, self._threads = socket, threads
        self._method = "StreamViews"

    async def send(self, request: v1.StreamViewsRequest) -> None:
        await in_thread(self._threads, self._socket.send, request.SerializeToString(), self._method)
        self._method = ""

    async def receive(self) -> v1.PointFrame:
        answer = await in_thread(self._threads, self._socket.receive)
        if isinstance(answer, Ended):
            raise BrokenError(error_of(answer.code, answer.message).code.name, answer.message)
        return v1.StreamViewsResponse.FromString(answer).frame

    async def close(self) -> None:
        self._socket.close()


async def open_web_socket(
    address: str, messages: tuple[Any, Any], session: str, threads: concurrent.futures.Executor
) -> WebSocketLine:
    """`messages`: of load_messages()."""

    def connect() -> WebSocket:
        return WebSocket(address, messages, timeout=FRAME_SECONDS, query=f"?key={session[:ROUTING_KEY_DIGITS]}")

    return WebSocketLine(await in_thread(threads, connect), threads)


async def in_thread(threads: concurrent.futures.Executor, what: Any, *arguments: Any) -> Any:
    try:
        return await asyncio.get_running_loop().run_in_executor(threads, what, *arguments)
    except ClosedError as error:  # a status of HTTP: the proxy has nobody to ask
        raise BrokenError("UNAVAILABLE", str(error)) from None
    except TimeoutError:
        raise BrokenError("DEADLINE_EXCEEDED", "no frame came") from None
    except OSError as error:
        raise BrokenError("UNAVAILABLE", str(error)) from None
