"""1,000 connections that say nothing, or half of something, to a server that may open 256 files: it tells its probes so all along.

TCP alone, HTTP/2's preface, WebSockets that are opened and then silent, and halves of a TLS handshake, held for half a minute.
"""

from __future__ import annotations

import contextlib
import resource
import socket
import ssl
import threading
import time

import grpc

from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import NOBODY, Caller
from hold.certificates import Certificates
from hold.history import now
from hold.report import Report, quantile
from hold.servers import Server, Setting, eventually
from hold.web_socket import opening

DESCRIPTORS, CONNECTIONS = 256, 1000
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes([0, 0, 0, 4, 0, 0, 0, 0, 0])  # and empty SETTINGS
CONNECT_SECONDS, PROBE_SECONDS, ACCEPT_SECONDS, DEAF_SECONDS = 2.0, 10.0, 5.0, 60.0
FEW = ("prlimit", f"--nofile={DESCRIPTORS}:{DESCRIPTORS}")


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    seconds = setting.pick(full=30, quick=6)
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))  # of this process, which holds the other ends
    certificates = Certificates(setting.folder)
    encrypted = ("--tls-cert", str(certificates.server.chain), "--tls-key", str(certificates.server.key))
    trust = certificates.credentials()
    hello = client_hello()
    total = Total()
    with Server(setting, "plain", "--admin", "127.0.0.1:0", prefix=FEW) as server:
        kinds = [(server.address, b""), (server.address, PREFACE), (server.http, b""), (server.http, opening(server.http))]
        besiege(setting, server, kinds, seconds, None, total)
    with Server(setting, "encrypted", "--admin", "127.0.0.1:0", *encrypted, prefix=FEW) as server:
        kinds = [(server.address, b""), (server.address, hello), (server.http, b""), (server.http, hello[: len(hello) // 2])]
        besiege(setting, server, kinds, seconds, trust, total)
    report.figure("connections", total.opened)
    report.figure("probes", len(total.probes))
    report.figure("ms longest probe", 1000 * max(total.probes, default=0))
    report.figure("ms median probe", 1000 * quantile(total.probes, 0.5))
    report.figure("calls answered meanwhile", total.answered)
    report.figure("calls meanwhile", total.tried)
    report.require("connections tried", total.opened, at_least=2 * CONNECTIONS)
    report.require("probes that failed", total.failed_probes, at_most=0)
    report.require("servers that did not accept again", total.deaf, at_most=0)
    report.require("s longest until one accepted again", total.longest, at_most=ACCEPT_SECONDS, timed=True)
    return report


class Total:
    """Of both servers together."""

    def __init__(self) -> None:
        self.probes: list[float] = []
        self.opened = self.failed_probes = self.answered = self.tried = self.deaf = 0
        self.longest = 0.0


def besiege(
    setting: Setting,
    server: Server,
    kinds: list[tuple[str, bytes]],
    seconds: float,
    trust: grpc.ChannelCredentials | None,
    total: Total,
) -> None:
    over = threading.Event()
    prober = threading.Thread(target=probe, args=(server, over, total), daemon=True)
    begin = now()
    held: list[socket.socket] = []
    prober.start()
    for number in range(CONNECTIONS):
        address, words = kinds[number % len(kinds)]
        with contextlib.suppress(OSError):  # the server's backlog may be full: that is the point
            held.append(hold(address, words))
        total.opened += 1
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with Caller(server, setting.history, "meanwhile", NOBODY, trust, patience=CONNECT_SECONDS) as caller:
            total.tried += 1
            total.answered += caller.call("ListSessions", v1.ListSessionsRequest()).is_ok
        time.sleep(0.5)
    for connection in held:
        connection.close()
    closed = now()
    accepts = False
    for _ in eventually(DEAF_SECONDS):
        with Caller(server, setting.history, "afterwards", NOBODY, trust, patience=ACCEPT_SECONDS) as caller:
            accepts = caller.call("ListSessions", v1.ListSessionsRequest()).is_ok
        if accepts:
            break
    total.deaf += not accepts
    total.longest = max(total.longest, now() - closed)
    over.set()
    prober.join()
    setting.history.tell("fault", server=server.name, begin=begin, end=closed + DEAF_SECONDS)


def hold(address: str, words: bytes) -> socket.socket:
    host, _, port = address.rpartition(":")
    connection = socket.create_connection((host, int(port)), timeout=CONNECT_SECONDS)
    with contextlib.suppress(OSError):
        connection.sendall(words)
    return connection


def probe(server: Server, over: threading.Event, total: Total) -> None:
    """As an orchestrator does, on the port that is for it."""
    while not over.wait(0.25):
        begin = time.monotonic()
        try:
            status, _ = server.get("/readyz", timeout=PROBE_SECONDS)
        except OSError:
            status = 0
        total.probes.append(time.monotonic() - begin)
        total.failed_probes += status != 200


def client_hello() -> bytes:
    """The first words of a TLS handshake."""
    into, out = ssl.MemoryBIO(), ssl.MemoryBIO()
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    talk = context.wrap_bio(into, out)
    with contextlib.suppress(ssl.SSLWantReadError):
        talk.do_handshake()
    return out.read()
