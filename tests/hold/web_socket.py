"""As little of a WebSocket client as it takes to make calls, and to stop in the middle: a library would not let us."""

from __future__ import annotations

import base64
import http.client
import io
import os
import socket
import ssl
import struct
import subprocess
import tempfile
from types import TracebackType
from typing import Any, NamedTuple, cast

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

BINARY, CLOSE, PING = 2, 8, 9
WEB_SOCKET_PROTO = "curvecast/v1/web_socket.proto"
PROTOCOL, BEARER = "curvecast.v1", "curvecast.bearer."


def opening(address: str, token: str = "", query: str = "") -> bytes:
    """The request that opens a socket."""
    protocols = PROTOCOL + (f", {BEARER}{base64.urlsafe_b64encode(token.encode()).decode().rstrip('=')}" if token else "")
    key = base64.b64encode(os.urandom(16)).decode()
    lines = [
        f"GET /v1/socket{query} HTTP/1.1",
        f"Host: {address}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
    ]
    return "\r\n".join([*lines, f"Sec-WebSocket-Key: {key}", f"Sec-WebSocket-Protocol: {protocols}", "", ""]).encode()


class ClosedError(Exception):
    """The server closed the socket, or refused to open it. code: of the protocol, or HTTP's status."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"{code}: {reason}")
        self.code = code


class Ended(NamedTuple):
    """How a call ended."""

    code: int  # of gRPC
    message: str
    messages: list[bytes]


def load_messages(source: str) -> tuple[Any, Any]:
    """CallRequest and CallResponse of web_socket.proto, which the Python client has no use for. `source`: the folder of the API."""
    with tempfile.NamedTemporaryFile() as file:
        subprocess.run(
            ["protoc", f"--proto_path={source}", "--include_imports", f"--descriptor_set_out={file.name}", WEB_SOCKET_PROTO],
            check=True,
        )
        described = descriptor_pb2.FileDescriptorSet.FromString(file.read())
    pool: Any = descriptor_pool.DescriptorPool()
    for one in described.file:
        pool.Add(one)
    factory: Any = message_factory.MessageFactory(pool)
    request, response = (pool.FindMessageTypeByName(f"curvecast.v1.{name}") for name in ("CallRequest", "CallResponse"))
    return factory.GetPrototype(request), factory.GetPrototype(response)


class WebSocket:
    """Open when it is constructed. ClosedError: the server will not have it."""

    def __init__(
        self,
        address: str,
        messages: tuple[Any, Any],
        token: str = "",
        tls: ssl.SSLContext | None = None,
        timeout: float = 30,
        query: str = "",
    ) -> None:
        self._request, self._response = messages
        self._call = 0
        self._ended: Ended | None = None
        host, _, port = address.rpartition(":")
        plain = socket.create_connection((host, int(port)), timeout=timeout)
        self._socket = tls.wrap_socket(plain, server_hostname=host) if tls is not None else plain
        self._buffer = b""
        self._socket.sendall(opening(address, token, query))
        while b"\r\n\r\n" not in self._buffer:
            self._receive()
        head, _, self._buffer = self._buffer.partition(b"\r\n\r\n")
        status = int(head.split()[1])
        if status != 101:
            raise ClosedError(status, head.decode(errors="replace"))
        self.headers = http.client.parse_headers(io.BytesIO(head.partition(b"\r\n")[2] + b"\r\n\r\n"))

    def __enter__(self) -> WebSocket:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    def call(self, method: str, *requests: bytes) -> Ended:
        """Makes a call and waits for its end."""
        for number, request in enumerate(requests):
            self.send(request, "" if number else method, is_last=number == len(requests) - 1)
        messages = []
        while not isinstance(answer := self.receive(), Ended):
            messages.append(answer)
        return answer._replace(messages=messages)

    def send(self, request: bytes, method: str = "", is_last: bool = False) -> None:
        """Sends a message of the last call. `method`: it begins the next one."""
        if method:
            self._call += 1
            self._ended = None
        self._send(self._request(call=self._call, method=method, message=request, half_close=is_last))

    def receive(self) -> bytes | Ended:
        """The next message of the last call, or how that ended, without messages."""
        while self._ended is None:
            response = self._response.FromString(self._message())
            if response.call != self._call:
                continue
            if response.HasField("status"):
                self._ended = Ended(response.status.code, response.status.message, [])
            if response.HasField("message"):
                return cast(bytes, response.message)
        return self._ended

    def _send(self, message: Any) -> None:
        self._send_frame(BINARY, message.SerializeToString())

    def _send_frame(self, kind: int, data: bytes) -> None:
        size = len(data)
        head = struct.pack("!BB", 0x80 | kind, 0x80 | size) if size < 126 else struct.pack("!BBH", 0x80 | kind, 0x80 | 126, size)
        if size > 65_535:
            head = struct.pack("!BBQ", 0x80 | kind, 0x80 | 127, size)
        self._socket.sendall(head + bytes(4) + data)  # the mask may be 0

    def _message(self) -> bytes:
        """The next whole message."""
        whole = b""
        while True:
            first, second = self._take(2)
            size = second & 127
            if size >= 126:
                size = int.from_bytes(self._take(2 if size == 126 else 8), "big")
            data = self._take(size)
            if first & 15 == CLOSE:
                raise ClosedError(int.from_bytes(data[:2], "big"), data[2:].decode(errors="replace"))
            if first & 15 == PING:
                self._send_frame(PING + 1, data)
                continue
            if first & 8:
                continue
            whole += data
            if first & 0x80:
                return whole

    def _take(self, size: int) -> bytes:
        while len(self._buffer) < size:
            self._receive()
        part, self._buffer = self._buffer[:size], self._buffer[size:]
        return part

    def _receive(self) -> None:
        data = self._socket.recv(1 << 16)
        if not data:
            raise ClosedError(0, "the connection ended")
        self._buffer += data
