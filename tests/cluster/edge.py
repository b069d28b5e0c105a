"""HAProxy before servers that share a cache, as deploy/cluster has them, and what happens to them."""

from __future__ import annotations

import asyncio
import collections
import concurrent.futures
import csv
import io
import os
import pathlib
import shutil
import signal
import socket
import subprocess
from collections.abc import Iterator
from types import TracebackType
from typing import NamedTuple

from hold.history import now
from hold.servers import END_SECONDS, READY_SECONDS, Server, Setting, eventually

CONFIGURATION = pathlib.Path(__file__).parents[2] / "deploy" / "haproxy" / "haproxy.cfg"
PROGRAM = shutil.which("haproxy", path=os.pathsep.join((os.environ.get("PATH", os.defpath), "/usr/sbin"))) or "haproxy"
PORTS = range(20_000, 32_000)  # below those that connections take, which would be in the way of a server that comes back
BACKENDS = ("grpc", "http")
REPLICA = "curvecast-replica"  # the header of an answer that names who gave it
LAME_DUCK = 2.0  # seconds


class Ports(NamedTuple):
    grpc: str
    http: str
    admin: str


class Edge:
    """The proxy, which is a Target, and its replicas r1, r2 ..., all up when it is entered. Constructed and used by the main
    thread. `stop_seconds`: that streams may go on through a proxy whose settings were read anew."""

    def __init__(self, setting: Setting, replicas: int, *options: str, stop_seconds: int = 3600) -> None:
        self.name = "edge"
        self.cache = setting.folder / "cache"
        self.replicas: dict[str, Server] = {}
        self._setting = setting
        self._options = (*options, "--trusted-proxy", "127.0.0.0/8", "--lame-duck", str(LAME_DUCK))
        self._free = free_ports(setting)
        self._members = {f"r{number}": next(self._free) for number in range(1, replicas + 1)}
        self._ports = next(self._free)
        self._socket = setting.folder / "haproxy.sock"
        self._stop_seconds = stop_seconds
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Edge:
        try:
            for name in self._members:
                self.start_replica(name)
            self.start_proxy()
        except BaseException:
            self._end(kill=True)
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self._end(kill=kind is not None)

    @property
    def address(self) -> str:
        return self._ports.grpc

    @property
    def http(self) -> str:
        return self._ports.http

    def metrics(self) -> dict[str, float]:
        """Those of all replicas together."""
        total: collections.Counter[str] = collections.Counter()
        for server in self.replicas.values():
            total.update(server.metrics())
        return dict(total)

    # ---------------------------------------------------------------------------------------------------------- the replicas

    def start_replica(self, name: str, ready: bool = True) -> Server:
        """Starts it for the first time, or again at its ports after it has ended."""
        if name in self.replicas:
            self.replicas[name].close(kill=True)
        ports = self._members[name]
        options = (*self._options, "--admin", ports.admin)
        server = Server(
            self._setting, name, *options, cache=self.cache, listen=ports.grpc, http=ports.http, ready=ready, keeps_uploads=True
        )
        self.replicas[name] = server
        return server

    def add_replica(self) -> None:
        """One more, of which the proxy hears when it starts anew."""
        name = f"r{len(self._members) + 1}"
        self._members[name] = next(self._free)
        self.start_replica(name)

    async def restart_replica(self, name: str) -> None:
        """Starts it again after its end, and waits until the proxy sends calls there."""
        server = self.start_replica(name, ready=False)
        await asyncio.to_thread(server.wait_until_ready)
        await asyncio.to_thread(self.wait_until_up)

    # ------------------------------------------------------------------------------------------------------------- the proxy

    def start_proxy(self, ready: bool = True) -> None:
        """`ready`: returns when all replicas are up."""
        sections = []
        for backend in BACKENDS:
            sections.append(f"backend {backend} from to-{backend}")
            for number, ports in enumerate(self._members.values(), 1):
                sections.append(f"  server r{number} {getattr(ports, backend)} id {number} port {ports.admin.rpartition(':')[2]}")
        replicas = self._setting.folder / "replicas.cfg"
        replicas.write_text("\n".join([*sections, ""]))
        environment = {
            "EDGE_GRPC": self._ports.grpc,
            "EDGE_HTTP": self._ports.http,
            "EDGE_ADMIN": self._ports.admin,
            "EDGE_SOCKET": str(self._socket),
            "EDGE_STOP": f"{self._stop_seconds}s",
        }
        self._socket.unlink(missing_ok=True)
        with open(self._setting.folder / "haproxy.log", "ab") as log:
            self._process = subprocess.Popen(
                ["setpriv", "--pdeathsig", "KILL", PROGRAM, "-W", "-f", str(CONFIGURATION), "-f", str(replicas)],
                stderr=log,
                stdout=log,
                env={**os.environ, **environment},
            )
        if ready:
            self.wait_until_up()
        self._setting.history.tell("serve", server=self.name, at=now(), store=str(self.cache), keeps_uploads=True, is_proxy=True)

    def stop_proxy(self) -> None:
        """At once, with all that goes through it."""
        assert self._process is not None
        self._setting.history.tell("end", server=self.name, at=now(), how="stopped")
        self._process.send_signal(signal.SIGTERM)
        self._process.wait(END_SECONDS)

    def reload_proxy(self) -> None:
        """Has it read its settings anew. Returns when the new process has taken over."""
        assert self._process is not None
        before = self._worker()
        self._process.send_signal(signal.SIGUSR2)
        for _ in eventually(READY_SECONDS):
            if self._worker() not in (before, ""):
                return
        raise RuntimeError(f"HAProxy did not start anew: see {self._setting.folder / 'haproxy.log'}")

    def wait_until_up(self) -> None:
        """RuntimeError: not all replicas are, in time, or the proxy has ended."""
        wanted = {(backend, name) for backend in BACKENDS for name in self._members}
        for _ in eventually(READY_SECONDS):
            if self._process is not None and self._process.poll() is not None:
                break
            if wanted <= {server for server, state in self._states().items() if state == "UP"}:
                return
        raise RuntimeError(f"HAProxy is not up: see {self._setting.folder / 'haproxy.log'}")

    def _ask(self, command: str) -> str:
        """Of the proxy's own socket; empty: it does not answer."""
        try:
            with socket.socket(socket.AF_UNIX) as line:
                line.settimeout(READY_SECONDS)
                line.connect(str(self._socket))
                line.sendall(f"{command}\n".encode())
                return b"".join(iter(lambda: line.recv(1 << 16), b"")).decode()
        except OSError:
            return ""

    def _states(self) -> dict[tuple[str, str], str]:
        rows = csv.DictReader(io.StringIO(self._ask("show stat").removeprefix("# ")))
        return {(row["pxname"], row["svname"]): row["status"] for row in rows}

    def _worker(self) -> str:
        """The number of the process that answers."""
        lines = dict(line.partition(": ")[::2] for line in self._ask("show info").splitlines())
        return lines.get("Pid", "")

    def _end(self, kill: bool) -> None:
        if self._process is not None and self._process.poll() is None:
            self.stop_proxy()
        with concurrent.futures.ThreadPoolExecutor() as pool:  # each takes its time
            list(pool.map(lambda server: server.close(kill), self.replicas.values()))


def free_ports(setting: Setting) -> Iterator[Ports]:
    """Addresses of the loopback where nobody listens."""
    found: list[str] = []
    for port in setting.random.sample(PORTS, len(PORTS)):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        found.append(f"127.0.0.1:{port}")
        if len(found) == len(Ports._fields):
            yield Ports(*found)
            found.clear()
