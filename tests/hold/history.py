"""Writes down every request and answer, as check_history reads them."""

from __future__ import annotations

import hashlib
import json
import pathlib
import threading
import time
from typing import Any


def now() -> float:
    """Seconds, of one clock for all processes of this machine."""
    return time.monotonic()


class History:
    """An object a line, in the order in which things ended. Thread-safe."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path
        self.calls = 0
        self._lock = threading.Lock()
        self._file = path.open("w", encoding="utf-8")

    def close(self) -> None:
        with self._lock:
            self._file.close()

    def flush(self) -> None:
        """For who reads it before it is closed."""
        with self._lock:
            self._file.flush()

    def tell(self, kind: str, **fields: Any) -> None:
        line = json.dumps({"kind": kind, **fields}) + "\n"
        with self._lock:
            if not self._file.closed:  # a call that ends after its scenario
                self._file.write(line)
                self.calls += kind == "call"


def digest_of(*parts: bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()[:32]
