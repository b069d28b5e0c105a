"""Retries and refusals, against a server whose answers the tests set."""

import unittest

import grpc

import curvecast
from curvecast.connection import is_retryable
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.v1 import status_pb2
from fake_server import FakeServerTest, block_of


class ConnectionTest(FakeServerTest):
    def test_lost_calls_are_repeated(self) -> None:
        for code in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED):
            self.service.failures, self.service.calls = [code, code], 0
            self.assertEqual(self.client.session("s").id, "s")
            self.assertEqual(self.service.calls, 3)
        self.service.failures, self.service.calls = 3 * [grpc.StatusCode.UNAVAILABLE], 0
        self.assert_refused("UNAVAILABLE", self.client.session, "s")
        self.assertEqual(self.service.calls, 3)

    def test_knows_what_a_proxy_has_lost(self) -> None:
        for message in ("Stream removed", "No status received"):
            self.assertTrue(is_retryable(curvecast.Error(grpc.StatusCode.UNKNOWN, message)))
        self.assertTrue(is_retryable(curvecast.Error(grpc.StatusCode.INTERNAL, "Received RST_STREAM with error code 2")))
        self.assertFalse(is_retryable(curvecast.Error(grpc.StatusCode.UNKNOWN, "something else")))

    def test_refused_calls_are_not(self) -> None:
        for code in (grpc.StatusCode.NOT_FOUND, grpc.StatusCode.INTERNAL, grpc.StatusCode.RESOURCE_EXHAUSTED):
            self.service.failures, self.service.calls = [code], 0
            self.assert_refused(code.name, self.client.session, "s")
            self.assertEqual(self.service.calls, 1)

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
            self.service.failures, self.service.trailers = [grpc.StatusCode.RESOURCE_EXHAUSTED], trailers
            with self.assertRaises(curvecast.Error) as caught:
                self.client.session("s")
            self.assertEqual((caught.exception.fields, caught.exception.retry_after), (fields, seconds))

    def test_closing_is_not_repeated(self) -> None:
        session = self.client.session("s")
        self.service.failures, self.service.calls = [grpc.StatusCode.UNAVAILABLE], 0
        self.assert_refused("UNAVAILABLE", session.close)
        self.assertEqual(self.service.calls, 1)

    def test_sessions_start_again(self) -> None:
        stages: list[str] = []
        self.service.failures = [grpc.StatusCode.UNAVAILABLE]
        self.assertEqual(self.client.open("m", on_progress=lambda stage, _: stages.append(stage)).id, "s")
        self.assertEqual(stages, ["read", "read"])

    def test_uploads_go_on_where_they_were(self) -> None:
        data = bytes(range(256)) * 5000
        self.service.failures = 2 * [grpc.StatusCode.UNAVAILABLE]
        fractions: list[float] = []
        self.client.upload_bytes("data", data, lambda _, fraction: fractions.append(fraction))
        self.assertEqual(self.service.parked, data)
        self.assertEqual(self.service.sent, [0, 512 << 10, 1024 << 10])
        self.assertEqual(fractions[-1], 1)

    def test_all_pages_of_sessions(self) -> None:
        self.assertEqual([session.id for session in self.client.sessions()], ["00", "01", "10", "11", "20", "21"])

    def test_all_pages_of_meshes(self) -> None:
        self.service.failures = [grpc.StatusCode.UNAVAILABLE]
        meshes = [(mesh.mesh_id, mesh.name, mesh.size) for mesh in self.client.meshes()]
        self.assertEqual(meshes, [(f"{page}{i}", "a.ply", page) for page in range(3) for i in range(2)])

    def test_exceptions_of_callbacks_come_out(self) -> None:
        def stop(*_: object) -> None:
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            self.client.open("m", on_progress=stop)
        with self.assertRaises(KeyError):
            self.client.upload_bytes("data", bytes(10_000_000), stop)

    def test_answers_that_make_no_sense(self) -> None:
        session = self.client.session("s")
        for points in ([], [block_of(9)], [block_of(8), block_of(3)], [v1.PointBlock(count=10)], [block_of(0)]):
            self.service.points = points
            self.assert_refused("DATA_LOSS", session.sample, 10)
        self.service.points = [block_of(8), block_of(2)]
        self.assertEqual(len(session.sample(10)), 10)

    def test_credentials(self) -> None:
        address = f"127.0.0.1:{self.secured_port}"
        with curvecast.connect(address, credentials=grpc.local_channel_credentials()) as client:
            self.assertEqual(client.session("s").id, "s")

    def test_every_call_brings_the_token(self) -> None:
        self.service.points = [block_of(10)]
        self.service.frames = [v1.PointFrame(kind=v1.FRAME_KIND_KEY)]
        with curvecast.connect(self.address, token="secret") as client:
            client.upload_bytes("data", b"bytes")
            session = client.open("m")
            session.sample(10)
            with session.stream() as stream:
                stream.send(curvecast.View(10))
                stream.frame()
            session.refresh()
            session.close()
        self.assertEqual(self.service.tokens, 6 * ["Bearer secret"])
        self.client.session("s")
        self.assertIsNone(self.service.tokens[-1])

    def test_calls_tell_proxies_which_mesh_they_are_about(self) -> None:
        self.service.points = [block_of(10)]
        self.service.frames = [v1.PointFrame(kind=v1.FRAME_KIND_KEY)]
        session = self.client.session("0123456789abcdef1111111111111111")
        session.sample(10)
        with session.stream() as stream:
            stream.send(curvecast.View(10))
            stream.frame()
        session.close()
        self.assertEqual(self.service.keys, 4 * ["0123456789abcdef"])
        mesh = self.client.upload_bytes("data", b"bytes")
        self.assertEqual(self.service.keys[-1], mesh.id[:16])
        self.client.open(mesh)
        self.assertEqual(self.service.keys[-1], mesh.id[:16])
        self.client.sessions()
        self.assertIsNone(self.service.keys[-1])

    def test_nobody_there(self) -> None:
        with curvecast.connect("127.0.0.1:1", attempts=2) as client:
            self.assert_refused("UNAVAILABLE", client.sessions)
        with self.assertRaises(ValueError):
            curvecast.connect("127.0.0.1:1", attempts=0)


if __name__ == "__main__":
    unittest.main()
