"""What goes wrong between a client and its server."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import grpc


class Error(Exception):
    """What the server refused, or the network lost. DATA_LOSS: the server's answer makes no sense."""

    def __init__(self, code: grpc.StatusCode, message: str) -> None:
        super().__init__(code, message)
        self.code = code  #: grpc.StatusCode, such as grpc.StatusCode.NOT_FOUND
        self.message = message  #: what was wrong, where, and what to do

    def __str__(self) -> str:
        return f"{self.code.name}: {self.message}"


def error_of(number: int, message: str) -> Error:
    """The error of a status code by its number in gRPC; UNKNOWN where there is none such."""
    codes = {code.value[0]: code for code in grpc.StatusCode if code is not grpc.StatusCode.OK}
    return Error(codes.get(number, grpc.StatusCode.UNKNOWN), message)


def bad_answer(message: str) -> Error:
    return Error(grpc.StatusCode.DATA_LOSS, message)


@contextlib.contextmanager
def translated() -> Iterator[None]:
    """Lets errors of gRPC leave as Error."""
    try:
        yield
    except grpc.RpcError as error:
        raise Error(error.code(), error.details() or "") from None
