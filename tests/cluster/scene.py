"""Sessions behind the proxy, what their points have to be, and a crowd that looks at them."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import math
import os
import pathlib
from collections.abc import AsyncIterator, Callable

from grpc import aio

from cluster.edge import Edge
from cluster.line import CHANNEL_OPTIONS, GrpcLine, Line, open_web_socket
from cluster.viewers import Crowd, Viewer
from curvecast.v1 import curvecast_pb2 as v1
from hold.calls import Caller
from hold.kills import CALM, Wanted
from hold.servers import WAIT, Server, Setting
from hold.shapes import orbit_view
from hold.web_socket import load_messages

SESSIONS, RINGS, POINTS = 8, 24, 4000  # rings of each mesh, points of each session
VIEWS, VIEW_POINTS = 24, 2000  # different ones of a session, points of each
INTERVAL = 0.25  # seconds between the views of a viewer
PATIENCE = 30.0  # seconds for what should take one


class Scene:
    """Made by the main thread. Its sessions are cached behind `edge`, and their points known by a calm server, when it is there."""

    def __init__(self, setting: Setting, edge: Edge) -> None:
        self.setting, self.edge = setting, edge
        self.sessions = [Wanted(seed, RINGS, POINTS) for seed in range(SESSIONS)]
        self.views = [orbit_view(VIEW_POINTS, 360 / VIEWS * number) for number in range(VIEWS)]
        self.messages = load_messages(str(pathlib.Path(os.environ["CURVECAST_SOURCE"], "proto")))
        with Server(setting, "calm", *CALM, reference=True) as calm, Caller(calm, setting.history, "reference") as caller:
            for wanted in self.sessions:
                make(caller, wanted)
                caller.sample(wanted.session, wanted.view)
            asyncio.run(self._look_at(calm))
        with Caller(edge, setting.history, "maker") as caller:
            for wanted in self.sessions:
                make(caller, wanted)
            saved = caller.wait_until_cached([wanted.session for wanted in self.sessions])
            if saved < len(self.sessions):
                raise RuntimeError(f"{saved} of {len(self.sessions)} sessions are in the cache")

    async def _look_at(self, calm: Server) -> None:
        crowd = Crowd(self.setting.history)
        async with aio.insecure_channel(calm.address, CHANNEL_OPTIONS) as channel:
            for wanted in self.sessions:

                async def open_line(session: str = wanted.session) -> Line:
                    return GrpcLine(channel, session)

                viewer = Viewer(crowd, calm, wanted.session, "reference", open_line)
                for view in self.views:
                    await viewer.look(view)
        if crowd.failed:
            raise RuntimeError(crowd.failed[0])

    @contextlib.asynccontextmanager
    async def crowd(self, grpc: int, web: int) -> AsyncIterator[tuple[Crowd, list[Viewer]]]:
        """So many viewers, by gRPC and by WebSocket, all of whom have seen something."""
        crowd, over = Crowd(self.setting.history), asyncio.Event()
        viewers: list[Viewer] = []
        tasks: list[asyncio.Task[None]] = []
        async with contextlib.AsyncExitStack() as stack:
            threads = stack.enter_context(concurrent.futures.ThreadPoolExecutor(2 * web + 1))
            for number in range(grpc + web):
                session = self.sessions[number % len(self.sessions)].session
                if number < grpc:
                    channel = await stack.enter_async_context(aio.insecure_channel(self.edge.address, CHANNEL_OPTIONS))
                    open_line = by_grpc(channel, session)
                else:
                    open_line = self._by_web_socket(session, threads)
                viewer = Viewer(crowd, self.edge, session, f"viewer {number}", open_line)
                offset = INTERVAL * (number * 0.618 % 1)
                tasks.append(asyncio.create_task(viewer.run(self._next_view(7 * number), INTERVAL, over.is_set, offset)))
                viewers.append(viewer)
            try:
                await all_see(viewers, crowd)
                yield crowd, viewers
            finally:
                over.set()
                await asyncio.gather(*tasks)

    def _next_view(self, first: int) -> Callable[[int], v1.SampleRequest]:
        return lambda number: self.views[(first + number) % len(self.views)]

    def _by_web_socket(self, session: str, threads: concurrent.futures.Executor) -> Callable[[], asyncio.Future[Line]]:
        return lambda: asyncio.ensure_future(open_web_socket(self.edge.http, self.messages, session, threads))


def by_grpc(channel: aio.Channel, session: str) -> Callable[[], asyncio.Future[Line]]:
    async def open_line() -> Line:
        return GrpcLine(channel, session)

    return lambda: asyncio.ensure_future(open_line())


def make(caller: Caller, wanted: Wanted) -> None:
    """Asks for a session, and notes its id."""
    caller.upload("ball.off", wanted.data)
    wanted.session = caller.create(wanted.mesh, wanted.points).value.session_id


async def all_see(viewers: list[Viewer], crowd: Crowd) -> None:
    """Waits until every viewer has points over the stream that he has now. RuntimeError: somebody stays without."""
    if await until(lambda: all(viewer.replica for viewer in viewers)) == math.inf:
        raise RuntimeError(f"viewers without points: {crowd.breaks[-1].error if crowd.breaks else crowd.failed}")


async def until(happened: Callable[[], bool], seconds: float = PATIENCE) -> float:
    """Waits for what is there to stay. How long that took, in seconds; infinite: longer than that."""
    loop = asyncio.get_running_loop()
    begin = loop.time()
    while not happened():
        if loop.time() > begin + seconds:
            return math.inf
        await asyncio.sleep(WAIT)
    return loop.time() - begin
