# SPDX-License-Identifier: Apache-2.0
"""Errors of the server and of the network."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping

import grpc
from google.protobuf.message import DecodeError

from curvecast.v1 import status_pb2 as status

DETAILS = "grpc-status-details-bin"  # the trailer that holds a Status


class Error(Exception):
    """Tells what the server refused or the network lost. The code DATA_LOSS: the server's answer breaks the protocol."""

    def __init__(
        self, code: grpc.StatusCode, message: str, fields: Mapping[str, str] | None = None, retry_after: float | None = None
    ) -> None:
        super().__init__(code, message)
        self.code = code  #: grpc.StatusCode, such as grpc.StatusCode.NOT_FOUND
        self.message = message  #: what was wrong, where, and what to do
        self.fields = dict(
            fields or {}
        )  #: fields of the request at fault: from the path, such as sample.cameras[0].eye.x, to what is wrong
        self.retry_after = retry_after  #: of RESOURCE_EXHAUSTED: seconds after which to try again

    def __str__(self) -> str:
        return f"{self.code.name}: {self.message}"


def error_of(number: int, message: str, retry_after: float | None = None) -> Error:
    """Makes the error of a status code, given by its number in gRPC; a number that gRPC does not have becomes UNKNOWN."""
    codes = {code.value[0]: code for code in grpc.StatusCode if code is not grpc.StatusCode.OK}
    return Error(codes.get(number, grpc.StatusCode.UNKNOWN), message, retry_after=retry_after)


def bad_answer(message: str) -> Error:
    """Makes the error for an answer of the server that breaks the protocol."""
    return Error(grpc.StatusCode.DATA_LOSS, message)


def error_of_call(error: grpc.RpcError) -> Error:
    """Turns an error of gRPC into an Error with the details that the server gave, as far as they can be read."""
    out = Error(error.code(), error.details() or "")
    trailers = {entry.key: entry.value for entry in error.trailing_metadata() or ()}
    with contextlib.suppress(DecodeError):
        for detail in status.Status.FromString(trailers.get(DETAILS, b"")).details:
            kind = detail.type_url.rpartition(".")[2]
            if kind == "RetryInfo":
                out.retry_after = status.RetryInfo.FromString(detail.value).retry_delay.ToTimedelta().total_seconds()
            elif kind == "BadRequest":
                violations = status.BadRequest.FromString(detail.value).field_violations
                out.fields.update({violation.field: violation.description for violation in violations})
    return out


@contextlib.contextmanager
def translate_errors() -> Iterator[None]:
    """Turns an error of gRPC that leaves the block into an Error."""
    try:
        yield
    except grpc.RpcError as error:
        raise error_of_call(error) from None
