"""Arrays as they come over the wire: little-endian bytes, so many values a row."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast.errors import bad_answer

#: Type and values a row of each column.
Columns = Mapping[str, tuple[str, int]]


def read_column(name: str, data: bytes, kind: tuple[str, int], rows: int | None = None) -> npt.NDArray[Any]:
    """(rows, width) or (rows,) values, not to be written to; `rows`: that there have to be. Error DATA_LOSS: other bytes than
    that, or floats that are not finite."""
    dtype, width = np.dtype(kind[0]), kind[1]
    if rows is None:
        rows = len(data) // (width * dtype.itemsize)
    if len(data) != rows * width * dtype.itemsize:
        raise bad_answer(f"the server sent {len(data)} bytes of {name} where {rows * width * dtype.itemsize} belong")
    values = np.frombuffer(data, dtype)
    if dtype.kind == "f" and not np.isfinite(values).all():
        raise bad_answer(f"the server sent {name} that are not finite")
    return values if width == 1 else values.reshape(rows, width)


def join_discs(what: str, chunks: Iterable[Any], columns: Columns, discs: int) -> list[dict[str, npt.NDArray[Any]]]:
    """The columns of each disc, whose chunks follow each other. Error DATA_LOSS: discs out of order, or other than so many."""
    parts: list[dict[str, list[npt.NDArray[Any]]]] = []
    for chunk in chunks:
        if chunk.disc == len(parts):
            parts.append({name: [] for name in columns})
        if chunk.disc + 1 != len(parts):
            raise bad_answer(f"the server sent a chunk of {what} of disc {chunk.disc} that does not fit")
        for name, kind in columns.items():
            parts[-1][name].append(read_column(name, getattr(chunk, name), kind))
    if len(parts) != discs:
        raise bad_answer(f"the server sent {what} of {len(parts)} discs, not {discs}")
    return [{name: np.concatenate(arrays) for name, arrays in disc.items()} for disc in parts]
