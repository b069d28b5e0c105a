"""100,000 absurd requests of every call over real connections, many on one stream: no crash, none hangs, no memory stays.

They are made from the API's descriptors, with hostile values in their fields, and half of them have spoilt bytes.
"""

from __future__ import annotations

import asyncio
import collections
import contextlib
import os
import random
from collections.abc import Iterator
from typing import Any

from grpc import aio

from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from hold.absurd import METHODS, Absurdity
from hold.calls import Caller, mesh_id_of
from hold.history import History, digest_of, now
from hold.load import open_aio
from hold.report import Report, quantile
from hold.servers import Server, Setting
from hold.shapes import bumpy_ball, plain_view

WORKERS = 24
SIZES = (100, 400)  # points of the sessions that there are
LEAST_WARMTH = 10_000  # requests
ON_ONE_STREAM = 40  # messages of a conversation, at most
PATIENCE = 120.0  # seconds
GROWTH = 64 << 20  # bytes
SERVICE = "/curvecast.v1.CurvecastService/"
LIMITS = ("--max-sessions", "16", "--max-meshes", "16MB", "--cache-size", "50MB", "--max-curve-vertices", "200000")


class Tally:
    def __init__(self, wanted: int) -> None:
        self.wanted = wanted
        self.requests = 0
        self.codes: collections.Counter[str] = collections.Counter()
        self.by_method: collections.Counter[str] = collections.Counter()
        self.seconds: list[float] = []


def run(setting: Setting) -> Report:
    report = Report(setting.is_quick)
    wanted = setting.pick(full=100_000, quick=6_000)
    folder = setting.folder / "meshes"
    folder.mkdir()
    mesh, kept = bumpy_ball(12), bumpy_ball(12, seed=1)
    (folder / "ball.off").write_bytes(mesh)
    options = (*LIMITS, "--mesh-folder", str(folder))
    with (
        Server(setting, "attacked", *options, cache=setting.folder / "cache", mesh_limit=16 << 20) as server,
        Caller(server, setting.history, "polite") as caller,
    ):
        for data in (mesh, kept):
            caller.upload("ball.off", data)
        names = [caller.create(mesh_id_of(mesh), points).value.session_id for points in SIZES]
        session = caller.create(mesh_id_of(kept), 1000).value.session_id
        before = caller.sample(session, plain_view(500)).value
        tally = Tally(wanted)
        with silence():
            asyncio.run(attack(server, setting, mesh, names, Tally(max(wanted // 10, LEAST_WARMTH))))  # buffers that stay
            base = server.unaccounted()
            asyncio.run(attack(server, setting, mesh, names, tally))
        is_alive = server.is_alive()
        growth = server.growth(base, GROWTH) if is_alive else 0.0
        caller.upload("ball.off", kept)  # where absurd ones took its place
        again = caller.create(mesh_id_of(kept), 1000)
        after = caller.sample(session, plain_view(500)).value if again.is_ok else ""
    report.require("absurd requests", tally.requests, at_least=wanted)
    report.figure("codes", dict(tally.codes.most_common()))
    report.figure("requests by call", dict(tally.by_method))
    report.figure("s longest call", max(tally.seconds, default=0))
    report.figure("ms p99 of a call", 1000 * quantile(tally.seconds, 0.99))
    report.require("crashes", int(not is_alive), at_most=0)
    report.require("calls that hang", tally.codes["DEADLINE_EXCEEDED"], at_most=0)
    report.require("bytes grown beside what is held", growth, at_most=GROWTH)
    report.require("wrong points afterwards", int(before != after), at_most=0)
    return report


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """protobuf tells standard error of every string that is none."""
    errors = os.dup(2)
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(errors, 2)
        os.close(errors)


async def attack(server: Server, setting: Setting, mesh: bytes, sessions: list[str], tally: Tally) -> None:
    async with open_aio(server) as one, open_aio(server) as other:
        absurdities = [Absurdity(random.Random(f"{setting.random.random()}"), [mesh_id_of(mesh)], sessions) for _ in range(WORKERS)]
        workers = [worker(server, (one, other)[n % 2], absurdities[n], tally, setting.history, n) for n in range(WORKERS)]
        restorer = asyncio.create_task(restore(one, mesh))
        await asyncio.gather(*workers)
        restorer.cancel()


async def restore(channel: aio.Channel, mesh: bytes) -> None:
    """Brings back what absurd calls have closed or pushed out."""
    stub = v1_grpc.CurvecastServiceStub(channel)
    header, chunk = v1.UploadHeader(name="ball.off", size=len(mesh)), v1.UploadMeshRequest(chunk=mesh)
    while True:
        with contextlib.suppress(aio.AioRpcError):
            await stub.UploadMesh(iter([v1.UploadMeshRequest(header=header), chunk]), timeout=PATIENCE)
            for points in SIZES:
                options = v1.SessionOptions(max_points=points)
                async for _ in stub.CreateSession(
                    v1.CreateSessionRequest(mesh_id=mesh_id_of(mesh), options=options), timeout=PATIENCE
                ):
                    pass
        await asyncio.sleep(0.05)


async def worker(server: Server, channel: aio.Channel, absurdity: Absurdity, tally: Tally, history: History, number: int) -> None:
    chance = random.Random(number)
    while tally.requests < tally.wanted and server.process.poll() is None:
        method = chance.choice(sorted(METHODS))
        many = chance.randrange(1, ON_ONE_STREAM) if METHODS[method].client_streaming else 1
        requests = [absurdity.request(method) for _ in range(many)]
        if method == "StreamViews" and chance.random() < 0.8:  # a conversation that begins well
            session = chance.choice(absurdity.sessions)
            requests[0] = v1.StreamViewsRequest(open=v1.OpenView(session_id=session, accept_deltas=True)).SerializeToString()
        tally.requests += many
        tally.by_method[method] += many
        begin = now()
        code, message = await ask(channel, method, requests)
        tally.codes[code] += 1
        tally.seconds.append(now() - begin)
        history.tell(
            "call",
            server=server.name,
            client=f"attacker {number}",
            caller="",
            call=f"absurd {method}",
            begin=begin,
            end=now(),
            code=code,
            request=digest_of(*requests),
            requests=many,
            message=message[:200],
        )


async def ask(raw: Any, method: str, requests: list[bytes]) -> tuple[str, str]:
    """Makes a call of bytes, reads all that comes, and returns how it ended. `raw`: a channel, whose stubs want serialisers."""
    kind = METHODS[method]
    path = SERVICE + method
    try:
        if kind.client_streaming and kind.server_streaming:
            return await converse(raw.stream_stream(path)(timeout=PATIENCE), requests)
        if kind.client_streaming:
            await raw.stream_unary(path)(iter(requests), timeout=PATIENCE)
        elif kind.server_streaming:
            async for _ in raw.unary_stream(path)(requests[0], timeout=PATIENCE):
                pass
        else:
            await raw.unary_unary(path)(requests[0], timeout=PATIENCE)
    except aio.AioRpcError as error:
        return error.code().name, error.details() or ""
    return "OK", ""


async def converse(call: Any, requests: list[bytes]) -> tuple[str, str]:
    """Sends as fast as it can, reads at the same time, and ends."""

    async def write() -> None:
        with contextlib.suppress(aio.AioRpcError, asyncio.InvalidStateError):  # the server has ended it
            for request in requests:
                await call.write(request)
            await call.done_writing()

    writer = asyncio.create_task(write())
    async for _ in call:
        pass
    await writer
    return (await call.code()).name, await call.details()
