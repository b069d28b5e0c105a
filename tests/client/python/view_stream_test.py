"""Conversations with a real server: what is held after deltas is what the server would send at once."""

import dataclasses
import random
import threading
import unittest
from typing import Any, ClassVar

import curvecast
from curvecast import Camera, Frame, View, ViewStream, density
from curvecast.v1 import curvecast_pb2 as v1
from fake_server import FakeServerTest, block_of
from fixture import WITH_DRACO, ServerTest, eye_at, present, sphere_obj

PATIENCE = 120  # seconds; nothing here takes that long unless it hangs


def view_from(degrees: float, distance: float, points: int) -> View:
    return View(points, sampler="progressive", density=density.view(), camera=Camera(eye_at(degrees, distance)))


class ViewStreamTest(ServerTest):
    session: ClassVar[curvecast.Session]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.session = cls.client.open(cls.client.upload_bytes("ball.obj", sphere_obj(24).encode()), 4000)
        # The candidates that views lack are made now: else their first frames would be coarse.
        for degrees in (0, 90, 180, 270):
            cls.session.sample(view_from(degrees, 1.2, 8000), patience=PATIENCE)

    def settled(self, stream: ViewStream, view: View, key_frame: bool = False) -> Frame:
        """The view's frames, until nothing better follows."""
        sequence = stream.send(view, key_frame)
        while True:
            frame = stream.frame(PATIENCE)
            self.assertIsNone(frame.error)
            if frame.sequence == sequence and not frame.statistics.refining:
                return frame

    def follow_random_views(self, count: int, **options: Any) -> None:
        chance = random.Random(7)
        degrees, distance, points = 0.0, 3.0, 400.0
        deltas = edits = 0
        with self.session.stream() as stream:
            for i in range(count):
                # Steps of all sizes, and sometimes somewhere else altogether.
                reach = 2 ** chance.uniform(-4, 4)
                degrees += chance.uniform(0, 360) if i % 37 == 0 else chance.uniform(-reach, reach)
                distance = min(max(distance * 2 ** (0.03 * chance.uniform(-reach, reach)), 1.1), 9)
                points = min(max(points * 2 ** (0.04 * chance.uniform(-reach, reach)), 40), 1500)
                # On one lattice: those that the pixels ask for differ from view to view, and each frame's points keep theirs.
                view = dataclasses.replace(view_from(degrees, distance, int(points)), position_bits=12, **options)
                frame = self.settled(stream, view)
                self.assertEqual(len(present(frame.points)), int(points))
                self.assert_same_points(present(frame.points), self.session.sample(view))
                if frame.is_delta:
                    deltas += 1
                    edits += frame.added + frame.removed + frame.resized
            stream.close()
        self.assertGreater(deltas, 0.8 * count)
        self.assertGreater(edits, deltas)

    def test_after_300_views_the_set_is_the_servers(self) -> None:
        self.follow_random_views(300, attributes=["rank"])

    @unittest.skipUnless(WITH_DRACO, "built without Draco")
    def test_draco_with_deltas(self) -> None:
        self.follow_random_views(100, encoding="draco")

    def test_all_attributes_come_along(self) -> None:
        self.follow_random_views(40, attributes=["surface", "curvatures", "rank", "directions", "scalars"])

    def test_the_newest_view_wins(self) -> None:
        with self.session.stream() as stream:
            for degrees in range(100):
                last = stream.send(view_from(degrees, 3, 1000))
            self.assertEqual(last, 100)
            sequences: list[int] = []
            while not sequences or sequences[-1] != last:
                sequences.append(stream.frame(PATIENCE).sequence)
            self.assertEqual(sequences, sorted(sequences))
            self.assert_refused("DEADLINE_EXCEEDED", "no frame", stream.frame, 0.01)

    def test_key_frames_on_request(self) -> None:
        with self.session.stream() as stream:
            self.assertFalse(self.settled(stream, view_from(0, 3, 1000)).is_delta)
            self.assertTrue(self.settled(stream, view_from(1, 3, 1000)).is_delta)
            self.assertFalse(self.settled(stream, view_from(2, 3, 1000), key_frame=True).is_delta)
        with self.session.stream(deltas=False) as stream:
            for degrees in range(3):
                frame = self.settled(stream, view_from(degrees, 3, 1000))
                self.assertEqual((frame.is_delta, frame.added), (False, 1000))
                self.assertGreaterEqual(frame.encoded_bytes, 28 * 1000)

    def test_a_stream_goes_on_where_another_broke_off(self) -> None:
        with self.session.stream() as stream:
            self.assertIsNone(stream.held())
            for degrees in range(3):
                self.settled(stream, view_from(degrees, 3, 1000))
            held = present(stream.held())
        self.assertEqual(len(held.points), 1000)
        view = view_from(4, 3, 1000)
        with self.session.stream(held=held) as stream:
            frame = self.settled(stream, view)
            self.assertTrue(frame.is_delta)
            self.assert_same_points(present(frame.points), self.session.sample(view))
        stale = dataclasses.replace(held, digest=held.digest ^ 1)
        with self.session.stream(held=stale) as stream:
            self.assertFalse(self.settled(stream, view).is_delta)

    def test_large_frames_come_in_parts(self) -> None:
        view = view_from(0, 3, 4000)
        with self.session.stream(first_bytes=5000) as stream:
            stream.send(view)
            frames = [stream.frame(PATIENCE)]
            while frames[-1].statistics.refining:
                frames.append(stream.frame(PATIENCE))
        self.assertGreater(len(frames), 1)
        counts = [len(present(frame.points)) for frame in frames]
        self.assertEqual(counts, sorted(counts))
        self.assertLess(counts[0], 1000)
        self.assertLess(frames[0].encoded_bytes, 10_000)
        self.assert_same_points(present(frames[-1].points), self.session.sample(view))

    def test_as_many_points_as_keep_up(self) -> None:
        with self.session.stream() as stream:
            frame = self.settled(stream, dataclasses.replace(view_from(0, 3, 1), points=None, frame_seconds=0.05))
            self.assertGreater(len(present(frame.points)), 1000)

    def test_frames_cannot_be_written_to(self) -> None:
        with self.session.stream() as stream:
            points = self.settled(stream, view_from(0, 3, 100)).points
            with self.assertRaises(ValueError):
                present(present(points).radii)[0] = 1

    def test_a_refused_view_leaves_the_points(self) -> None:
        with self.session.stream() as stream:
            before = self.settled(stream, view_from(0, 3, 1000))
            stream.send(View(1000, density=density.view()))  # without a camera
            refused = stream.frame(PATIENCE)
            self.assertEqual(present(refused.error).code.name, "INVALID_ARGUMENT")
            self.assertIs(refused.points, before.points)
            self.assertTrue(self.settled(stream, view_from(1, 3, 1000)).is_delta)
            with self.assertRaises(ValueError):
                stream.send(View())

    def test_a_frame_that_makes_no_sense_is_followed_by_a_key_frame(self) -> None:
        with self.session.stream() as stream:
            view = view_from(0, 3, 1000)
            self.settled(stream, view)
            stream._points = None  # as after a frame that could not be decoded
            stream.send(view_from(1, 3, 1000))
            self.assert_refused("DATA_LOSS", "frame 2", stream.frame, PATIENCE)
            frame = self.settled(stream, view)
            self.assertFalse(frame.is_delta)
            self.assert_same_points(present(frame.points), self.session.sample(view))

    def test_how_streams_end(self) -> None:
        with curvecast.connect(self.server.address) as client:
            stranger = curvecast.Session(client._connection, v1.Session(session_id="unknown"))
            with stranger.stream() as stream:
                self.assert_refused("NOT_FOUND", "unknown", stream.frame, PATIENCE)
                self.assert_refused("NOT_FOUND", "unknown", stream.send, View(10))
                self.assert_refused("NOT_FOUND", "unknown", stream.close)
        with self.session.stream() as stream:
            stream.send(view_from(0, 3, 100))
            stream.close()
            self.assert_refused("ABORTED", "ended", stream.send, View(10))
            self.assert_refused("ABORTED", "ended", stream.frame)

    def test_another_thread_may_wait_for_frames(self) -> None:
        with self.session.stream() as stream:
            frames: list[Frame] = []

            def wait() -> None:
                while not frames or frames[-1].sequence != 50:
                    frames.append(stream.frame(PATIENCE))

            waiting = threading.Thread(target=wait)
            waiting.start()
            for degrees in range(50):
                stream.send(view_from(degrees, 3, 200))
            waiting.join()
        self.assertTrue(all(frame.error is None and len(present(frame.points)) == 200 for frame in frames))

    def test_cancelling_wakes_who_waits(self) -> None:
        stream = self.session.stream()
        threading.Timer(0.05, stream.cancel).start()
        self.assert_refused("CANCELLED", "", stream.frame)


class FakeViewStreamTest(FakeServerTest):
    def test_frames_that_make_no_sense(self) -> None:
        def key(count: int = 2, **fields: Any) -> v1.PointFrame:
            defaults: dict[str, Any] = {"kind": v1.FRAME_KIND_KEY, "points": [block_of(count)], "held_points": count}
            return v1.PointFrame(**defaults | fields)

        def delta(**fields: Any) -> v1.PointFrame:
            defaults: dict[str, Any] = {"kind": v1.FRAME_KIND_DELTA, "held_points": 2}
            return v1.PointFrame(**defaults | fields)

        bad = [
            key(kind=v1.FRAME_KIND_UNSPECIFIED),
            key(held_points=3),
            key(points=[v1.PointBlock(count=2)]),
            key(points=[v1.PointBlock(count=3_000_000), v1.PointBlock(count=3_000_000)]),
            delta(held_points=1),
            delta(edits=v1.PointEdits(removed=[2])),
            delta(edits=v1.PointEdits(added=[0]), points=[block_of(2)]),
        ]
        good = [key(1), delta(held_points=2, points=[block_of(1)], edits=v1.PointEdits(added=[1]))]
        with self.client.session("s").stream() as stream:
            for frame in bad:
                self.service.frames = [*good, frame, key(0), delta(held_points=0)]
                for count in (1, 2):
                    stream.send(View(10))
                    self.assertEqual(len(present(stream.frame(PATIENCE).points)), count)
                stream.send(View(10))
                self.assert_refused("DATA_LOSS", stream.frame, PATIENCE)
                for _ in range(2):
                    stream.send(View(10))
                    self.assertEqual(len(present(stream.frame(PATIENCE).points)), 0)
            stream.close()
        views = [request.view for request in self.service.requests if request.HasField("view")]
        # Only the view after a bad frame asks for all points.
        self.assertEqual([view.key_frame for view in views], len(bad) * [False, False, False, True, False])
        # Every frame is acknowledged once, good or bad.
        acks = [request.ack.sequence for request in self.service.requests if request.HasField("ack")]
        self.assertEqual(acks, [view.sequence for view in views])

    def test_errors_of_frames(self) -> None:
        self.service.frames = [v1.PointFrame(error=v1.FrameError(code=8, message="later", retry_after=2.5))]
        with self.client.session("s").stream() as stream:
            stream.send(View(10))
            error = present(stream.frame(PATIENCE).error)
            self.assertEqual((error.code.name, error.message, error.retry_after), ("RESOURCE_EXHAUSTED", "later", 2.5))


if __name__ == "__main__":
    unittest.main()
