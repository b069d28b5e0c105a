"""Memory that the machine has at hand: what is timed is then the server, not the machine that lends it memory."""

from __future__ import annotations

import mmap
import os
import time

from hold.report import Report

LEAST, MOST_OF_FREE = 4 << 30, 0.75  # bytes; what the scenarios take anew is less


def warm_memory(report: Report) -> None:
    """Touches memory that nobody uses, twice, and reports what a page took. A virtual machine's host may have taken back what was
    idle: the first touch of each page is then as long as that of dozens, and holds its core, whoever else waits for it."""
    size = min(LEAST, int(MOST_OF_FREE * os.sysconf("SC_AVPHYS_PAGES") * mmap.PAGESIZE))
    for when in ("cold", "warm"):
        report.figure(f"µs of a page of {when} memory", touch(size))


def touch(size: int) -> float:
    """Microseconds for each page of so many bytes."""
    pages = size // mmap.PAGESIZE
    begin = time.monotonic()
    with mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS) as memory:
        memory[:: mmap.PAGESIZE] = bytes(pages)
        return 1e6 * (time.monotonic() - begin) / pages
