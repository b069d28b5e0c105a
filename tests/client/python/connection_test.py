"""Retries and refusals, against servers that do as they are told."""

import concurrent.futures
import unittest
from collections.abc import Iterator

import grpc
import numpy as np

import curvecast
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import curvecast_pb2_grpc as v1_grpc
from curvecast.v1 import status_pb2


class Told(v1_grpc.CurvecastServiceServicer):
    """Fails with the codes in `failures`, one call after the other, then answers."""

    def __init__(self) -> None:
        self.failures: list[grpc.StatusCode] = []
        self.calls = 0
        self.trailers: list[tuple[str, bytes]] = []
        self.points: list[v1.PointBlock] = []
        self.parked = b""  # of an upload that broke off
        self.sent: list[int] = []  # bytes that each upload began with

    def _answer(self, context: grpc.ServicerContext) -> None:
        self.calls += 1
        context.set_trailing_metadata(self.trailers)
        if self.failures:
            context.abort(self.failures.pop(0), "as told")

    def GetSession(self, request: v1.GetSessionRequest, context: grpc.ServicerContext) -> v1.GetSessionResponse:
        self._answer(context)
        return v1.GetSessionResponse(session=v1.Session(session_id=request.session_id))

    def CloseSession(self, _: v1.CloseSessionRequest, context: grpc.ServicerContext) -> v1.CloseSessionResponse:
        self._answer(context)
        return v1.CloseSessionResponse()

    def GetMesh(self, _: v1.GetMeshRequest, context: grpc.ServicerContext) -> v1.GetMeshResponse:
        context.abort(grpc.StatusCode.NOT_FOUND, "no such mesh")

    def GetUpload(self, _: v1.GetUploadRequest, context: grpc.ServicerContext) -> v1.GetUploadResponse:
        return v1.GetUploadResponse(received=len(self.parked))

    def UploadMesh(self, requests: Iterator[v1.UploadMeshRequest], context: grpc.ServicerContext) -> v1.UploadMeshResponse:
        self.sent.append(next(requests).header.offset)
        for request in requests:
            self.parked += request.chunk
            self._answer(context)
        return v1.UploadMeshResponse()

    def ListSessions(self, request: v1.ListSessionsRequest, context: grpc.ServicerContext) -> v1.ListSessionsResponse:
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


class ConnectionTest(unittest.TestCase):
    def setUp(self) -> None:
        self.told = Told()
        server = grpc.server(concurrent.futures.ThreadPoolExecutor(4))
        v1_grpc.add_CurvecastServiceServicer_to_server(self.told, server)
        port = server.add_insecure_port("127.0.0.1:0")
        self.secured_port = server.add_secure_port("127.0.0.1:0", grpc.local_server_credentials())
        server.start()
        self.addCleanup(lambda: server.stop(0).wait())
        self.client = curvecast.connect(f"127.0.0.1:{port}", attempts=3)
        self.addCleanup(self.client.close)

    def assert_refused(self, code: str, call: object, *arguments: object) -> None:
        with self.assertRaises(curvecast.Error) as caught:
            call(*arguments)
        self.assertEqual(caught.exception.code.name, code)

    def test_lost_calls_are_repeated(self) -> None:
        for code in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED):
            self.told.failures, self.told.calls = [code, code], 0
            self.assertEqual(self.client.session("s").id, "s")
            self.assertEqual(self.told.calls, 3)
        self.told.failures, self.told.calls = 3 * [grpc.StatusCode.UNAVAILABLE], 0
        self.assert_refused("UNAVAILABLE", self.client.session, "s")
        self.assertEqual(self.told.calls, 3)

    def test_refused_calls_are_not(self) -> None:
        for code in (grpc.StatusCode.NOT_FOUND, grpc.StatusCode.INTERNAL, grpc.StatusCode.RESOURCE_EXHAUSTED):
            self.told.failures, self.told.calls = [code], 0
            self.assert_refused(code.name, self.client.session, "s")
            self.assertEqual(self.told.calls, 1)

    def test_details_of_refusals(self) -> None:
        rich = status_pb2.Status()
        retry = status_pb2.RetryInfo()
        retry.retry_delay.FromMilliseconds(1500)
        bad = status_pb2.BadRequest(field_violations=[status_pb2.BadRequest.FieldViolation(field="a.b", description="is wrong")])
        for name, detail in (("RetryInfo", retry), ("BadRequest", bad), ("Unheard", bad)):
            rich.details.add(type_url=f"type.googleapis.com/google.rpc.{name}", value=detail.SerializeToString())
        for trailers, fields, seconds in (
            ([("grpc-status-details-bin", rich.SerializeToString())], {"a.b": "is wrong"}, 1.5),
            ([("grpc-status-details-bin", b"\xff\xff")], {}, None),
            ([], {}, None),
        ):
            self.told.failures, self.told.trailers = [grpc.StatusCode.RESOURCE_EXHAUSTED], trailers
            with self.assertRaises(curvecast.Error) as caught:
                self.client.session("s")
            self.assertEqual((caught.exception.fields, caught.exception.retry_after), (fields, seconds))

    def test_closing_is_not_repeated(self) -> None:
        session = self.client.session("s")
        self.told.failures, self.told.calls = [grpc.StatusCode.UNAVAILABLE], 0
        self.assert_refused("UNAVAILABLE", session.close)
        self.assertEqual(self.told.calls, 1)

    def test_sessions_start_again(self) -> None:
        stages: list[str] = []
        self.told.failures = [grpc.StatusCode.UNAVAILABLE]
        self.assertEqual(self.client.open("m", on_progress=lambda stage, _: stages.append(stage)).id, "s")
        self.assertEqual(stages, ["read", "read"])

    def test_uploads_go_on_where_they_were(self) -> None:
        data = bytes(range(256)) * 5000
        self.told.failures = 2 * [grpc.StatusCode.UNAVAILABLE]
        fractions: list[float] = []
        self.client.upload_bytes("data", data, lambda _, fraction: fractions.append(fraction))
        self.assertEqual(self.told.parked, data)
        self.assertEqual(self.told.sent, [0, 512 << 10, 1024 << 10])
        self.assertEqual(fractions[-1], 1)

    def test_all_pages_of_sessions(self) -> None:
        self.assertEqual([session.id for session in self.client.sessions()], ["00", "01", "10", "11", "20", "21"])

    def test_exceptions_of_callbacks_come_out(self) -> None:
        def stop(*_: object) -> None:
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            self.client.open("m", on_progress=stop)
        with self.assertRaises(KeyError):
            self.client.upload_bytes("data", bytes(10_000_000), stop)

    def test_answers_that_make_no_sense(self) -> None:
        def block(count: int) -> v1.PointBlock:
            ones = np.ones(3 * count, "<f4").tobytes()
            raw = v1.RawPoints(positions=ones, normals=ones, radii=ones[: 4 * count])
            return v1.PointBlock(count=count, raw=raw)

        session = self.client.session("s")
        for points in ([], [block(9)], [block(8), block(3)], [v1.PointBlock(count=10)], [block(0)]):
            self.told.points = points
            self.assert_refused("DATA_LOSS", session.sample, 10)
        self.told.points = [block(8), block(2)]
        self.assertEqual(len(session.sample(10)), 10)

    def test_credentials(self) -> None:
        address = f"127.0.0.1:{self.secured_port}"
        with curvecast.connect(address, credentials=grpc.local_channel_credentials()) as client:
            self.assertEqual(client.session("s").id, "s")

    def test_nobody_there(self) -> None:
        with curvecast.connect("127.0.0.1:1", attempts=2) as client:
            self.assert_refused("UNAVAILABLE", client.sessions)
        with self.assertRaises(ValueError):
            curvecast.connect("127.0.0.1:1", attempts=0)


if __name__ == "__main__":
    unittest.main()
