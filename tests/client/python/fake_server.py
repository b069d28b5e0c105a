"""A server in this process whose answers a test sets."""

import concurrent.futures
import unittest
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import grpc
import numpy as np

import curvecast
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc


class FakeService(v1_grpc.CurvecastServiceServicer):
    """Fails with the codes in `failures`, one call after the other, then answers."""

    def __init__(self) -> None:
        self.failures: list[grpc.StatusCode] = []
        self.calls = 0
        self.tokens: list[str | bytes | None] = []  # that each call came with
        self.keys: list[str | bytes | None] = []
        self.frames: list[v1.PointFrame] = []  # that answer views, one after the other
        self.requests: list[v1.StreamViewsRequest] = []
        self.trailers: Sequence[tuple[str, str | bytes]] = []
        self.points: list[v1.PointBlock] = []
        self.parked = b""  # of an upload that broke off
        self.sent: list[int] = []  # bytes that each upload began with

    def _answer(self, context: grpc.ServicerContext) -> None:
        self.calls += 1
        self.tokens.append(dict(context.invocation_metadata()).get("authorization"))
        self.keys.append(dict(context.invocation_metadata()).get("curvecast-key"))
        context.set_trailing_metadata(tuple(self.trailers))
        if self.failures:
            context.abort(self.failures.pop(0), "as the test wants")

    def GetSession(self, request: v1.GetSessionRequest, context: grpc.ServicerContext) -> v1.GetSessionResponse:
        self._answer(context)
        return v1.GetSessionResponse(session=v1.Session(session_id=request.session_id))

    def CloseSession(self, _: v1.CloseSessionRequest, context: grpc.ServicerContext) -> v1.CloseSessionResponse:
        self._answer(context)
        return v1.CloseSessionResponse()

    def GetMesh(self, _: v1.GetMeshRequest, context: grpc.ServicerContext) -> v1.GetMeshResponse:
        context.abort(grpc.StatusCode.NOT_FOUND, "no such mesh")

    def GetUpload(self, _: v1.GetUploadRequest, __: grpc.ServicerContext) -> v1.GetUploadResponse:
        return v1.GetUploadResponse(received=len(self.parked))

    def UploadMesh(self, requests: Iterator[v1.UploadMeshRequest], context: grpc.ServicerContext) -> v1.UploadMeshResponse:
        self.sent.append(next(requests).header.offset)
        for request in requests:
            self.parked += request.chunk
            self._answer(context)
        return v1.UploadMeshResponse()

    def ListMeshes(self, request: v1.ListMeshesRequest, context: grpc.ServicerContext) -> v1.ListMeshesResponse:
        self._answer(context)
        page = int(request.page_token or 0)
        meshes = [v1.StoredMesh(mesh_id=f"{page}{i}", name="a.ply", size=page) for i in range(2)]
        return v1.ListMeshesResponse(meshes=meshes, next_page_token=str(page + 1) if page < 2 else "")

    def ListSessions(self, request: v1.ListSessionsRequest, context: grpc.ServicerContext) -> v1.ListSessionsResponse:
        self._answer(context)
        page = int(request.page_token or 0)
        sessions = [v1.Session(session_id=f"{page}{i}") for i in range(2)]
        return v1.ListSessionsResponse(sessions=sessions, next_page_token=str(page + 1) if page < 2 else "")

    def CreateSession(self, _: v1.CreateSessionRequest, context: grpc.ServicerContext) -> Iterator[v1.CreateSessionResponse]:
        yield v1.CreateSessionResponse(progress=v1.Progress(stage="read", fraction=0.5))
        self._answer(context)
        yield v1.CreateSessionResponse(session=v1.Session(session_id="s"))

    def Resample(self, _: v1.ResampleRequest, context: grpc.ServicerContext) -> Iterator[v1.ResampleResponse]:
        self._answer(context)
        for block in self.points:
            yield v1.ResampleResponse(points=block)

    def StreamViews(
        self, requests: Iterator[v1.StreamViewsRequest], context: grpc.ServicerContext
    ) -> Iterator[v1.StreamViewsResponse]:
        self._answer(context)
        for request in requests:
            self.requests.append(request)
            if request.HasField("view"):
                frame = self.frames.pop(0)
                frame.sequence = request.view.sequence
                yield v1.StreamViewsResponse(frame=frame)


class FakeServerTest(unittest.TestCase):
    """One FakeService on a free port, and a client of it, for each test."""

    def setUp(self) -> None:
        self.service = FakeService()
        server = grpc.server(concurrent.futures.ThreadPoolExecutor(4))
        v1_grpc.add_CurvecastServiceServicer_to_server(self.service, server)
        port = server.add_insecure_port("127.0.0.1:0")
        self.secured_port = server.add_secure_port("127.0.0.1:0", grpc.local_server_credentials())
        server.start()
        self.addCleanup(lambda: server.stop(0).wait())
        self.address = f"127.0.0.1:{port}"
        self.client = curvecast.connect(self.address, attempts=3)
        self.addCleanup(self.client.close)

    def assert_refused(self, code: str, call: Callable[..., object], *arguments: Any) -> None:
        with self.assertRaises(curvecast.Error) as caught:
            call(*arguments)
        self.assertEqual(caught.exception.code.name, code)


def block_of(count: int) -> v1.PointBlock:
    """Raw points, all at (1, 1, 1)."""
    ones = np.ones(3 * count, "<f4").tobytes()
    return v1.PointBlock(count=count, raw=v1.RawPoints(positions=ones, normals=ones, radii=ones[: 4 * count]))
