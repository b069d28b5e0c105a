# SPDX-License-Identifier: Apache-2.0
"""Surfaces in this process: see client/python/native. Messages are those of the API, as bytes; threads: 0 = one a core."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

_OnProgress = Callable[[str, float], None] | None

class Error(Exception):
    """(code, message): code as gRPC numbers them."""

    args: tuple[int, str]

class Surface:
    @staticmethod
    def make(
        vertices: npt.NDArray[np.float64],
        faces: npt.NDArray[np.int64],
        colours: npt.NDArray[np.uint8] | None,
        scalars: Mapping[str, npt.NDArray[np.float32]],
        name: str,
        options: bytes,
        prepares: bool,
        threads: int,
        on_progress: _OnProgress,
    ) -> Surface: ...
    @staticmethod
    def read(
        name: str,
        data: bytes,
        companions: Mapping[str, bytes],
        options: bytes,
        prepares: bool,
        threads: int,
        on_progress: _OnProgress,
    ) -> Surface: ...
    def info(self) -> bytes: ...
    def sample(self, request: bytes, threads: int) -> dict[str, Any]: ...
    def scatter(self, request: bytes, threads: int, on_progress: _OnProgress) -> dict[str, Any]: ...
    def remesh(self, request: bytes, threads: int, on_progress: _OnProgress) -> list[bytes]: ...
    def features(self, degrees: float, points: int, seed: int, threads: int) -> dict[str, Any]: ...
    def distances(self, points: npt.NDArray[np.float64], threads: int) -> npt.NDArray[np.float64]: ...
    def mesh(self) -> dict[str, Any]: ...
    def measure(self, request: bytes, sets: Sequence[npt.NDArray[np.float64]], threads: int, on_progress: _OnProgress) -> bytes: ...

class Stream:
    def __init__(self, surface: Surface) -> None: ...
    def frame(self, request: bytes, key_frame: bool, threads: int) -> bytes: ...

def references(name: str, data: bytes, companions: Mapping[str, bytes]) -> list[str]: ...
def scatter_file(
    name: str,
    data: bytes,
    companions: Mapping[str, bytes],
    request: bytes,
    crease_degrees: float | None,
    threads: int,
    on_progress: _OnProgress,
) -> dict[str, Any]: ...
def scatter(
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int64],
    colours: npt.NDArray[np.uint8] | None,
    scalars: Mapping[str, npt.NDArray[np.float32]],
    name: str,
    request: bytes,
    crease_degrees: float | None,
    threads: int,
    on_progress: _OnProgress,
) -> dict[str, Any]: ...
