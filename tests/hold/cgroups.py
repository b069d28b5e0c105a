"""A control group that bounds a server's memory, of version 1 or 2, where one can be made here."""

from __future__ import annotations

import contextlib
import os
import pathlib
import time
from collections.abc import Iterator

ROOT = pathlib.Path("/sys/fs/cgroup")


class MemoryGroup:
    def __init__(self, folder: pathlib.Path, is_second: bool) -> None:
        self._folder, self._is_second = folder, is_second

    @property
    def prefix(self) -> tuple[str, ...]:
        """Of a command that is to run in it."""
        return ("sh", "-c", 'echo $$ >"$0/cgroup.procs" && exec "$@"', str(self._folder))

    def kills(self) -> int:
        """Processes that it has killed for want of memory."""
        text = (self._folder / ("memory.events" if self._is_second else "memory.oom_control")).read_text()
        return int(dict(line.split() for line in text.splitlines()).get("oom_kill", 0))

    def peak(self) -> int:
        """Bytes, of all that counts towards its limit, files too; 0: it is not told."""
        path = self._folder / ("memory.peak" if self._is_second else "memory.max_usage_in_bytes")
        return int(path.read_text()) if path.exists() else 0


@contextlib.contextmanager
def memory_group(limit: int) -> Iterator[MemoryGroup]:
    """OSError: there is none to be had."""
    first, is_second = ROOT / "memory", False
    if (ROOT / "cgroup.controllers").exists():
        first, is_second = ROOT, True
        with contextlib.suppress(OSError):
            (ROOT / "cgroup.subtree_control").write_text("+memory")
    elif not first.is_dir():
        raise OSError("there is no hierarchy of control groups with memory")
    folder = first / f"curvecast-hold-{os.getpid()}"
    folder.mkdir()
    try:
        (folder / ("memory.max" if is_second else "memory.limit_in_bytes")).write_text(str(limit))
        yield MemoryGroup(folder, is_second)
    finally:
        for _ in range(100):  # it is there until the last process of it has gone
            with contextlib.suppress(OSError):
                folder.rmdir()
                break
            time.sleep(0.05)
