"""What nobody should give to surfaces in Python's own process, and calls that end before their time. deploy/wheel --sanitise runs
this with AddressSanitizer, which sees what is read or written beside its place."""

from __future__ import annotations

import contextlib
import gc
import pathlib
import signal
import tempfile
import threading
import unittest
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.testing
from shapes import cube, torus

import curvecast
from curvecast import _native, density

NAN, INF = float("nan"), float("inf")
#: What hostile values end as: never as SystemError or MemoryError, which would be faults of the module.
ENDS = (TypeError, ValueError, OverflowError, curvecast.Error, _native.Error)


@contextlib.contextmanager
def interrupted_after(seconds: float) -> Iterator[None]:
    """Raises KeyboardInterrupt on this thread, as Ctrl-C does, so many seconds later and at the latest at the end."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
        signal.pause()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def stop(_stage: str, _fraction: float) -> None:
    raise RuntimeError("enough")


class HostileTest(unittest.TestCase):
    surface: curvecast.Surface
    wanted: curvecast.Points

    @classmethod
    def setUpClass(cls) -> None:
        cls.surface = curvecast.Surface(*torus())
        cls.wanted = cls.surface.sample(5000)

    def assert_ends(self, call: Callable[..., object], *arguments: Any, **options: Any) -> None:
        with self.subTest(call=getattr(call, "__qualname__", call), arguments=str(arguments)[:200], options=str(options)[:200]):
            with self.assertRaises(ENDS) as caught:
                call(*arguments, **options)
            self.assertTrue(str(caught.exception))

    def assert_sound(self) -> None:
        """The surface gives what it gave."""
        numpy.testing.assert_array_equal(self.surface.sample(5000).positions, self.wanted.positions)

    def test_arrays(self) -> None:
        vertices, faces = torus(6, 5)
        odd: list[Any] = [None, 7, "text", b"bytes", object(), {}, [[]], [[1, 2], [3]], np.zeros((0, 3, 1)), np.zeros(3, "U5")]
        odd += [np.zeros((2, 3, 3)), vertices[..., None]]
        no_numbers = [np.zeros((3, 3), "datetime64[s]"), np.zeros((3, 3), object)]
        for value in odd + no_numbers:
            self.assert_ends(curvecast.Surface, value, faces)
            self.assert_ends(curvecast.Surface, vertices, value)
            self.assert_ends(curvecast.Surface, vertices, faces, scalars={"a": value})
            if value is not None:
                self.assert_ends(curvecast.Surface, vertices, faces, colours=value)
            self.assert_ends(self.surface.signed_distance, value)
        for value in odd:
            self.assert_ends(self.surface.measure, value)
        for place in (NAN, INF, -INF):
            for row in (0, len(vertices) - 1):
                bad = vertices.copy()
                bad[row, 2] = place
                self.assert_ends(curvecast.Surface, bad, faces)
                self.assert_ends(self.surface.signed_distance, bad)
                self.assert_ends(self.surface.measure, bad)
        for index in (-1, len(vertices), 2**31, 2**32, 2**63 - 1, -(2**63)):
            beyond = faces.copy()
            beyond[-1, 2] = index
            self.assert_ends(curvecast.Surface, vertices, beyond)
        self.assert_ends(curvecast.Surface, vertices, faces, colours=np.zeros((29, 3), np.uint8))
        for name in (7, None, b"a", "\udcff"):
            self.assert_ends(curvecast.Surface, vertices, faces, scalars={name: vertices[:, 0]})
            self.assert_ends(curvecast.Surface, vertices, faces, name=name)
        self.assert_sound()

    def test_numbers_beside_the_mesh_may_be_anything(self) -> None:
        vertices, faces = torus(6, 5)
        values = np.resize(np.array([NAN, INF, -INF, 3e38, 0, -0.0]), len(vertices))
        surface = curvecast.Surface(vertices, faces, scalars={"": values, "ünï": values[::-1]})
        points = surface.sample(500, attributes=["scalars"])
        self.assertEqual({name: len(column) for name, column in points.scalars.items()}, {"": 500, "ünï": 500})

    def test_places_of_all_sizes(self) -> None:
        vertices, faces = cube()
        for size in (1e-300, 1e-38, 1e-10, 1e10, 1e38, 1e200, 1e308):
            with self.subTest(size), contextlib.suppress(curvecast.Error):
                self.assertTrue(np.isfinite(curvecast.Surface(size * vertices, faces).sample(100).world_positions()).all())

    def test_the_module_itself(self) -> None:
        vertices, faces = torus(6, 5)
        native, empty = self.surface._native, b""
        for message in (b"\xff", b"\x0a\xff\xff\xff\xff\x0f", b"\x00" * 100, bytes(range(256))):
            self.assert_ends(_native.Surface.make, vertices, faces, None, {}, "mesh", message, 0, None)
            self.assert_ends(_native.Surface.read, "mesh.off", b"OFF", {}, message, 0, None)
            self.assert_ends(native.sample, message, 0)
            self.assert_ends(native.remesh, message, 0, None)
            self.assert_ends(native.measure, message, [], 0, None)
            self.assert_ends(_native.Stream(native).frame, message, False, 0)
        for array in (vertices.T, vertices[::2], vertices.astype(np.float32), vertices.astype(">f8"), vertices[:, :2], vertices[0]):
            self.assert_ends(native.distances, array.astype(array.dtype), "0")
            self.assert_ends(_native.Surface.make, array[:, :2] if array.ndim == 2 else array, faces, None, {}, "", empty, 0, None)
        self.assert_ends(_native.Surface, vertices)
        self.assert_ends(_native.Stream, None)
        self.assert_ends(_native.Stream, 7)
        self.assert_ends(_native.Stream.__new__(_native.Stream).frame, empty, False, 0)
        self.assert_ends(_native.Surface.__new__(_native.Surface).info)

    def test_numbers_of_calls(self) -> None:
        vertices, faces = torus(6, 5)
        before = resident()
        for points in (-1, 4_000_001, 2**32, 2**63, 2**64, 1.5, NAN, "7"):
            self.assert_ends(self.surface.sample, points)
            self.assert_ends(self.surface.remesh, points)
            self.assert_ends(self.surface.features, points)
            self.assert_ends(curvecast.Surface, vertices, faces, points=points)
        self.assertLess(resident() - before, 500 << 20)  # no curve was made for so many
        for degrees in (NAN, INF, -1.0, 181.0, "7"):
            self.assert_ends(self.surface.features, 10, degrees)
        for threads in (-1, 1025, 2**31, 1.5, NAN):
            self.assert_ends(curvecast.Surface, vertices, faces, threads=threads)
        numpy.testing.assert_array_equal(curvecast.Surface(*torus(), threads=1024).sample(5000).positions, self.wanted.positions)
        for relaxations in (-1, 2**32, 10**6):
            self.assert_ends(self.surface.remesh, 100, relaxations=relaxations)
        self.assert_ends(self.surface.measure, vertices, ring_seeds=2**31)
        self.assert_sound()

    def test_files(self) -> None:
        vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        sound = vertices + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
        with tempfile.TemporaryDirectory() as folder:
            for name in ("ö.obj", "a b.obj", "\udcff.obj", "<b>&.obj"):  # the third one is not of UTF-8
                path = pathlib.Path(folder, name)
                path.write_text(sound)
                self.assertEqual(len(curvecast.read(path).sample(10)), 10)
                path.write_text(vertices + "f 1 2 9\n")
                with self.subTest(name.encode("utf-8", "replace")), self.assertRaisesRegex(curvecast.Error, "obj"):
                    curvecast.read(path)
            path = pathlib.Path(folder, "bytes.obj")
            for bad in (b"f 1 2 \xff\xfe\n", b"\xc3\x28\n", b"v \xff 0 0\n", b"f 1 2 3\x00\n", b"\x00" * 1000):
                path.write_bytes(vertices.encode() + bad)
                self.assert_ends(curvecast.read, path)
            path.write_bytes(b"mtllib \xff.mtl ../../etc/passwd\nusemtl \xfe\n" + sound.encode())
            self.assertTrue(curvecast.read(path).info.warnings)
            for ending in ("ply", "obj", "off", "stl", "gltf", "glb", "3mf", "xyz", ""):
                path = pathlib.Path(folder, f"junk.{ending}")
                for data in (
                    b"",
                    b"\n",
                    bytes(range(256)) * 20,
                    b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n",
                ):
                    path.write_bytes(data)
                    self.assert_ends(curvecast.read, path)

    def test_callbacks_that_raise(self) -> None:
        mesh = torus(300, 200)
        large = curvecast.Surface(*mesh)
        points = large.sample(100_000)
        told: list[str] = []
        for name, call in (
            ("make", lambda on: curvecast.Surface(*mesh, on_progress=on)),
            ("remesh", lambda on: large.remesh(100_000, on_progress=on)),
            ("measure", lambda on: large.measure(points, on_progress=on)),
        ):
            with self.subTest(name), self.assertRaisesRegex(RuntimeError, "enough"):
                call(stop)
            with self.subTest(name), self.assertRaises(TypeError):
                call(7)
            call(lambda stage, _fraction: told.append(f"{stage} {len(self.surface.sample(10))}"))  # within a call
        self.assertTrue(told)
        self.assert_sound()

    def test_calls_that_are_interrupted(self) -> None:
        mesh = torus(300, 200)
        large = curvecast.Surface(*mesh)
        points = large.sample(100_000)
        stream = large.stream()
        view = curvecast.View(100_000, camera=curvecast.Camera((3, 0, 1)), density=density.picture())
        calls: list[Callable[[], object]] = [
            lambda: curvecast.Surface(*mesh),
            lambda: curvecast.Surface(*mesh, threads=1).sample(300_000, relaxation_rounds=50),
            lambda: large.sample(300_000, relaxation_rounds=100),
            lambda: large.sample(200_000, sampler="progressive", seed=7),
            lambda: stream.frame(view),
            lambda: large.remesh(100_000, relaxations=50),
            lambda: large.measure(points, ball_centres=100_000),
            lambda: large.signed_distance(points.world_positions()),
            lambda: large.features(100_000, 1),
        ]
        for number, call in enumerate(calls):
            for seconds in (0.001, 0.1, 0.3):
                with self.subTest(call=number, seconds=seconds), self.assertRaises(KeyboardInterrupt), interrupted_after(seconds):
                    call()
        numpy.testing.assert_array_equal(large.sample(100_000).positions, points.positions)
        frame, whole = stream.frame(view), large.stream().frame(view)
        assert frame.points is not None and whole.points is not None
        numpy.testing.assert_array_equal(frame.points.positions, whole.points.positions)

    def test_objects_that_go_while_others_use_what_they_had(self) -> None:
        surface = curvecast.Surface(*torus())
        stream, points = surface.stream(), surface.sample(3000, attributes=["surface", "curvatures", "directions"])
        columns = [column[::7] for column in points.columns().values()]
        wanted = [column.copy() for column in columns]
        view = curvecast.View(3000, camera=curvecast.Camera((3, 0, 1)))
        going = threading.Thread(
            target=lambda: [surface.sample(3000) for surface in [curvecast.Surface(*torus())] for _ in range(3)]
        )
        going.start()
        del surface, points
        gc.collect()
        for column, before in zip(columns, wanted, strict=True):
            numpy.testing.assert_array_equal(column, before)
        self.assertGreater(len(stream.frame(view).points or ()), 0)
        going.join()

    def test_nothing_is_kept_of_calls_that_fail(self) -> None:
        vertices, faces = torus(60, 50)
        broken = faces.copy()
        broken[-1] = len(vertices)
        plain = curvecast.Surface(vertices, faces)

        def work() -> None:
            with self.assertRaises(curvecast.Error):
                curvecast.Surface(vertices, broken)
            with self.assertRaises(RuntimeError):
                curvecast.Surface(*torus(200, 100), on_progress=stop)
            with self.assertRaises(KeyboardInterrupt), interrupted_after(0.001):
                plain.sample(50_000, relaxation_rounds=100)
            with self.assertRaises(curvecast.Error):
                plain.measure(vertices * np.inf)
            curvecast.Surface(vertices, faces).stream().frame(curvecast.View(3000, camera=curvecast.Camera((3, 0, 1))))

        for _ in range(5):
            work()
        gc.collect()
        before = resident()
        for _ in range(20):
            work()
        gc.collect()
        self.assertLess(resident() - before, 60 << 20)


def resident() -> int:
    """Bytes of memory that this process has."""
    return int(pathlib.Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096


if __name__ == "__main__":
    unittest.main()
