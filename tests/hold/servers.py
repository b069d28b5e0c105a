"""Real servers on the loopback, on free ports, which end with the test however it ends."""

from __future__ import annotations

import collections
import contextlib
import dataclasses
import http.client
import math
import os
import pathlib
import random
import select
import signal
import subprocess
import time
from collections.abc import Iterator
from types import TracebackType
from typing import IO, Any, NamedTuple, Protocol, cast

from hold.history import History, now

READY_SECONDS, END_SECONDS = 60.0, 120.0
ANY_PORT = "127.0.0.1:0"
WAIT = 0.05  # between looks at what is to come
GIVES_BACK = 40.0  # seconds: pauses of a server that gives back what it has to spare, and some


@dataclasses.dataclass
class Setting:
    """What a scenario runs in."""

    command: pathlib.Path  # the built curvecast
    folder: pathlib.Path  # of this scenario, empty
    history: History
    random: random.Random
    is_quick: bool
    is_hour: bool = False

    def pick(self, full: int, quick: int, hour: int | None = None) -> int:
        return quick if self.is_quick else hour if self.is_hour and hour is not None else full


class Usage(NamedTuple):
    resident: int  # bytes
    descriptors: int
    threads: collections.Counter[str]  # by name


class Target(Protocol):
    """Whom callers call: a server, or what stands before several."""

    name: str

    @property
    def address(self) -> str: ...

    def metrics(self) -> dict[str, float]: ...


class Server:
    """A server under test, ready when it is constructed. Constructed by the main thread only: the kernel ends the server with the
    thread that started it. `cache`: its folder, which is also its store in the history. `tells`: what the history says of it."""

    def __init__(
        self,
        setting: Setting,
        name: str,
        *options: str,
        cache: pathlib.Path | None = None,
        prefix: tuple[str, ...] = (),
        listen: str = ANY_PORT,
        http: str = ANY_PORT,
        ready: bool = True,
        **tells: Any,
    ) -> None:
        self.name = name
        self._history = setting.history
        self._ports: dict[str, str] = {}
        self._tells = {"store": str(cache) if cache is not None else name, **tells}
        command = [*prefix, "setpriv", "--pdeathsig", "KILL", str(setting.command), "serve", "--listen", listen]
        # Kills are not the sessions' fault.
        command += ["--http", http, "--crash-pause", "0"]
        command += [*(["--cache", str(cache)] if cache is not None else []), *options]
        self.log = setting.folder / f"{name}.log"
        self.is_ended = False
        # Not in a session of its own: Linux gives each as much of the cores as any other (sched(7), autogroup), so that work of low
        # priority would yield to its own server's alone, and not to the proxy, or to other servers.
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log)
        if ready:
            self.wait_until_ready()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self.close(kill=kind is not None)

    def close(self, kill: bool) -> None:
        """Ends it, in order or not, if it has not ended."""
        if not kill and not self.is_ended:
            self.stop()
        elif self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        cast(IO[bytes], self.process.stdout).close()

    def wait_until_ready(self) -> None:
        """RuntimeError: it has not said so in time, or has ended."""
        output = cast(IO[bytes], self.process.stdout)
        text, end = b"", time.monotonic() + READY_SECONDS
        while b"\nhttp on " not in text or not text.endswith(b"\n"):
            readable, _, _ = select.select([output], [], [], max(0.0, end - time.monotonic()))
            part = os.read(output.fileno(), 65_536) if readable else b""
            if not part:
                self.process.kill()
                raise RuntimeError(f"the server {self.name} did not start: see {self.log}")
            text += part
        for line in text.decode().splitlines():
            what, _, address = line.partition(" on ")
            self._ports[what] = address
        self._history.tell("serve", server=self.name, at=now(), **self._tells)

    @property
    def address(self) -> str:
        return self._ports["listening"]

    @property
    def http(self) -> str:
        return self._ports["http"]

    @property
    def admin(self) -> str:
        return self._ports.get("admin", self.http)

    def is_alive(self) -> bool:
        """Tells, and writes down an end that nobody asked for."""
        if self.is_ended or self.process.poll() is None:
            return not self.is_ended
        self._tell_end("crashed")
        return False

    def stop(self) -> None:
        """Asks it to end, and waits. What ends otherwise than in order has crashed."""
        if not self.is_alive():
            return
        begin = now()
        self.process.send_signal(signal.SIGTERM)
        try:
            status = self.process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            status = self.process.wait()
        self._tell_end("stopped" if status == 0 else "crashed", begin)

    def kill(self) -> None:
        self._tell_end("killed")
        self.process.kill()
        self.process.wait()

    def tell_killed(self, at: float) -> None:
        """A signal that was sent then has ended it."""
        self._tell_end("killed", at)

    def get(self, path: str, port: str | None = None, timeout: float = 10) -> tuple[int, str]:
        """Of the HTTP port, in plain text: status and body. OSError: it does not answer."""
        connection = http.client.HTTPConnection(port or self.admin, timeout=timeout)
        try:
            connection.request("GET", path)
            response = connection.getresponse()
            return response.status, response.read().decode()
        except http.client.HTTPException as error:
            raise ConnectionError(str(error)) from error
        finally:
            connection.close()

    def metrics(self) -> dict[str, float]:
        """Every value of /metrics by its name with labels; and by its bare name the sum over all labels."""
        values: dict[str, float] = {}
        for line in self.get("/metrics")[1].splitlines():
            if line.startswith("#") or not line:
                continue
            name, _, value = line.rpartition(" ")
            values[name] = float(value)
            if "{" in name:
                bare = name.partition("{")[0]
                values[bare] = values.get(bare, 0) + float(value)
        return values

    def usage(self) -> Usage:
        folder = pathlib.Path("/proc", str(self.process.pid))
        lines = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines() if ":" in line)
        threads = collections.Counter(task.read_text().strip() for task in folder.glob("task/*/comm"))
        return Usage(1024 * int(lines["VmRSS"].split()[0]), len(list((folder / "fd").iterdir())), threads)

    def unaccounted(self) -> float:
        """Bytes that it takes when all calls are over, beside what it holds."""
        for _ in eventually(30):
            metrics = self.metrics()
            if not any(metrics.get(f"curvecast_{name}") for name in ("open_streams", "queue_depth", "memory_reserved_bytes")):
                break
        return self.usage().resident - self.metrics()["curvecast_memory_held_bytes"]

    def growth(self, base: float, allowed: float) -> float:
        """How much larger unaccounted() is than it was: what is freed goes back to the system now and then only."""
        least = math.inf
        for _ in eventually(GIVES_BACK):
            least = min(least, self.unaccounted() - base)
            if least <= allowed:
                break
        return least

    def log_lines(self, *words: str) -> list[str]:
        """Those of its log that hold all of these words."""
        lines = self.log.read_text(errors="replace").splitlines()
        return [line for line in lines if all(word in line for word in words)]

    def _tell_end(self, how: str, at: float | None = None) -> None:
        self.is_ended = True
        self._history.tell("end", server=self.name, at=now() if at is None else at, how=how)


def eventually(seconds: float) -> Iterator[None]:
    """Goes round until so much time is over: for what is there to stay, with a break where it is there."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        yield
        time.sleep(WAIT)


def temporaries(folder: pathlib.Path) -> list[str]:
    """Names of unfinished files of a cache."""
    with contextlib.suppress(FileNotFoundError):
        return [path.name for path in folder.iterdir() if path.name.endswith(".curvecast-tmp")]
    return []
