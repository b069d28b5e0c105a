"""Neighbours of points, of a real server, and answers that make no sense."""

import unittest
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import numpy.typing as npt

import curvecast
from curvecast import View
from curvecast.neighbours import decode_neighbours
from curvecast.v1 import curvecast_pb2 as v1
from fixture import ServerTest, sphere_obj


def all_distances(points: curvecast.Points) -> npt.NDArray[np.float64]:
    """(N, N), infinite from a point to itself."""
    places = points.positions.astype(np.float64)
    distances: npt.NDArray[np.float64] = np.sqrt(((places[:, None] - places[None]) ** 2).sum(axis=2))
    np.fill_diagonal(distances, np.inf)
    return distances


class NeighboursTest(ServerTest):
    session: ClassVar[curvecast.Session]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.session = cls.client.open(cls.client.upload_bytes("ball.obj", sphere_obj(16).encode()), 4000)

    def test_the_nearest(self) -> None:
        for view in (View(1500), View(1500, sampler="progressive")):
            found = self.session.neighbours(view, k=8)
            self.assertEqual(found.indices.shape, (1500, 8))
            self.assertEqual((found.indices.dtype, found.distances.dtype), (np.uint32, np.float32))
            self.assert_same_points(found.points, self.session.sample(view))
            distances = all_distances(found.points)
            np.testing.assert_allclose(found.distances, np.sort(distances, axis=1)[:, :8], rtol=1e-4)
            np.testing.assert_allclose(np.take_along_axis(distances, found.indices, axis=1), found.distances, rtol=1e-4)
            np.testing.assert_array_equal(found.starts, 8 * np.arange(1501))
            np.testing.assert_array_equal(found.of(7), found.indices[7])

    def test_within_a_radius(self) -> None:
        told: list[tuple[str, float]] = []
        found = self.session.neighbours(1500, radius=0.15, on_progress=lambda *step: told.append(step))
        distances = all_distances(found.points)
        rows, columns = np.nonzero(distances <= 0.15)
        np.testing.assert_array_equal(found.indices, columns)
        np.testing.assert_array_equal(np.repeat(np.arange(1500), np.diff(found.starts)), rows)
        np.testing.assert_allclose(found.distances, distances[rows, columns], rtol=1e-4)
        self.assertEqual(told[-1], ("neighbours", 1))
        self.assertEqual(len(self.session.neighbours(100, radius=1e-9).indices), 0)

    def test_there_are_no_more_than_others(self) -> None:
        self.assertEqual(self.session.neighbours(3, k=8).indices.shape, (3, 2))
        self.assertEqual(self.session.neighbours(1, k=8).indices.shape, (1, 0))

    def test_what_makes_no_sense(self) -> None:
        with self.assertRaises(ValueError):
            self.session.neighbours(100)
        with self.assertRaises(ValueError):
            self.session.neighbours(100, k=8, radius=1)
        self.assert_refused("INVALID_ARGUMENT", "count is 65", self.session.neighbours, 100, k=65)
        self.assert_refused("INVALID_ARGUMENT", "radius is 0", self.session.neighbours, 100, radius=0)
        self.assert_refused("OUT_OF_RANGE", "64000000", self.session.neighbours, 4_000_000, k=20)

    def test_bad_answers(self) -> None:
        def answer() -> list[v1.FindNeighboursResponse]:
            ones = np.ones(9, "<f4").tobytes()
            block = v1.PointBlock(count=3, raw=v1.RawPoints(positions=ones, normals=ones, radii=ones[:12]))
            lists = {"counts": np.array([2, 2, 2], "<u4"), "indices": np.array([1, 2, 0, 2, 0, 1], "<u4")}
            chunk = v1.NeighbourChunk(distances=np.zeros(6, "<f4").tobytes(), **{name: v.tobytes() for name, v in lists.items()})
            points = v1.ResampleResponse(points=block)
            return [v1.FindNeighboursResponse(points=points), v1.FindNeighboursResponse(neighbours=chunk)]

        def assert_bad(spoil: Callable[[v1.NeighbourChunk], object], most: int = 3, k: int = 2) -> None:
            messages = answer()
            spoil(messages[1].neighbours)
            with self.assertRaises(curvecast.Error) as caught:
                decode_neighbours(messages, most, k)
            self.assertEqual(caught.exception.code.name, "DATA_LOSS")

        def put(name: str, kind: str, *values: float) -> Callable[[v1.NeighbourChunk], None]:
            return lambda chunk: setattr(chunk, name, np.array(values, kind).tobytes())

        self.assertEqual(decode_neighbours(answer(), 3, 2).indices.tolist(), [[1, 2], [0, 2], [0, 1]])
        assert_bad(lambda _: None, most=2)
        assert_bad(lambda _: None, k=1)
        assert_bad(lambda chunk: chunk.ClearField("counts"))
        assert_bad(lambda chunk: setattr(chunk, "indices", chunk.indices[:-1]))
        assert_bad(lambda chunk: setattr(chunk, "distances", chunk.distances[:-4]))
        assert_bad(put("counts", "<u4", 1, 3, 2))
        assert_bad(put("counts", "<u4", 2, 2, 2**32 - 1))
        assert_bad(put("indices", "<u4", 1, 2, 0, 2, 0, 3))
        assert_bad(put("indices", "<u4", 1, 2, 0, 1, 0, 1))
        assert_bad(put("distances", "<f4", 0, 0, 0, 0, 0, np.nan))
        assert_bad(put("distances", "<f4", 0, 0, 0, 0, 0, -1))
        with self.assertRaises(curvecast.Error):
            decode_neighbours([], 3, 2)


if __name__ == "__main__":
    unittest.main()
