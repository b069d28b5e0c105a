# SPDX-License-Identifier: Apache-2.0
"""Decodes arrays of the API: little-endian bytes, a fixed number of values in each row."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast.errors import bad_answer

#: From the name of each column to the type of its values and their number in a row.
Columns = Mapping[str, tuple[str, int]]


def read_column(name: str, data: bytes, kind: tuple[str, int], rows: int | None = None, *, finite: bool = True) -> npt.NDArray[Any]:
    """Decodes a column to an array of shape (rows, width), or (rows,) for a width of 1, which cannot be written to. `rows`: the
    number that there has to be; None: any. Error DATA_LOSS: another number of bytes, or floats that are not finite where they have
    to be."""
    dtype, width = np.dtype(kind[0]), kind[1]
    if rows is None:
        rows = len(data) // (width * dtype.itemsize)
    if len(data) != rows * width * dtype.itemsize:
        raise bad_answer(f"the server sent {len(data)} bytes of {name} where {rows * width * dtype.itemsize} belong")
    values = np.frombuffer(data, dtype)
    if finite and dtype.kind == "f" and not np.isfinite(values).all():
        raise bad_answer(f"the server sent {name} that are not finite")
    return values if width == 1 else values.reshape(rows, width)


def join_discs(what: str, chunks: Iterable[Any], columns: Columns, discs: int) -> list[dict[str, npt.NDArray[Any]]]:
    """Joins the chunks of each disc to its columns. The chunks of a disc follow each other. Error DATA_LOSS: discs out of order, or
    another number of them than `discs`."""
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
