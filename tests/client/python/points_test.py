"""Blocks of points, good and bad ones."""

import subprocess
import sys
import unittest

import numpy as np

import curvecast
from curvecast.points import as_points, decode_blocks, encoded_bytes
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1
from fixture import WITH_DRACO, present


def raw_block(count: int, origin: float = 0, **columns: object) -> v1.PointBlock:
    values = {"positions": np.ones((count, 3)), "normals": np.zeros((count, 3)), "radii": np.ones(count)} | columns
    data = {name: np.asarray(value, "u1" if name == "colours" else "<f4").tobytes() for name, value in values.items()}
    return v1.PointBlock(count=count, origin=v1.Vec3(x=origin), raw=v1.RawPoints(**data))


def described_block(count: int, direction: list[float], **scalars: list[float]) -> v1.PointBlock:
    """With directions, all of their coordinates the same, and named values."""
    block = raw_block(count)
    block.attributes.directions = np.array(3 * count * direction, "<f4").tobytes()
    for name, values in scalars.items():
        block.attributes.scalars.add(name=name, values=np.array(values, "<f4").tobytes())
    return block


def run_python(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True, check=False)


class PointsTest(unittest.TestCase):
    def assert_bad(self, message: str, *blocks: v1.PointBlock) -> None:
        with self.assertRaises(curvecast.Error) as caught:
            decode_blocks(blocks)
        self.assertEqual(caught.exception.code.name, "DATA_LOSS")
        self.assertIn(message, caught.exception.message)

    def test_a_limit_has_a_name(self) -> None:
        def limit(value: int) -> str | None:
            points = as_points(np.zeros((1, 3)))
            points.statistics.limit = value  # type: ignore[assignment]  # as from the wire
            return points.limit

        self.assertIsNone(limit(0))
        self.assertEqual([limit(value) for value in range(1, 5)], ["bytes", "density", "server", "coming"])
        self.assertEqual(limit(77), "unknown")

    def test_blocks_are_joined(self) -> None:
        points = decode_blocks([raw_block(2, 10), raw_block(0, 10), raw_block(3, 12)])
        np.testing.assert_array_equal(points.world_positions()[:, 0], [11, 11, 13, 13, 13])
        self.assertEqual(points.positions.dtype, np.float32)
        self.assertIsNone(points.colours)
        points.positions[0] = 7  # arrays of their own
        self.assertEqual(len(decode_blocks([])), 0)

    def test_bad_blocks(self) -> None:
        self.assert_bad("positions", raw_block(2, positions=np.ones(5)))
        self.assert_bad("radii", raw_block(2, radii=[]))
        self.assert_bad("colours", raw_block(2, colours=[1, 2, 3]))
        self.assert_bad("not finite", raw_block(2, positions=np.full(6, np.nan)))
        self.assert_bad("below 0", raw_block(2, radii=[1, -1]))
        self.assert_bad("origin", raw_block(2, np.inf))
        self.assert_bad("neither", v1.PointBlock(count=2))
        self.assert_bad("others without", raw_block(1, colours=[1, 2, 3]), raw_block(1))
        short = raw_block(2)
        short.attributes.ranks = bytes(7)
        self.assert_bad("ranks", short)
        self.assert_bad("directions that are not finite", described_block(2, [np.nan]))
        self.assert_bad("bytes of heat", described_block(2, [1], heat=[1, 2, 3]))
        self.assert_bad("scalar age", described_block(2, [1], heat=[1, 2]), described_block(2, [1], heat=[1, 2], age=[3, 4]))
        twice = described_block(2, [1], heat=[1, 2])
        twice.attributes.scalars.add(name="heat", values=bytes(8))
        self.assert_bad("heat", twice)

    def test_named_values_need_not_be_numbers(self) -> None:
        block = described_block(2, [1], heat=[np.nan, 7], age=[np.inf, 8])
        points = decode_blocks([block, block])
        np.testing.assert_array_equal(points.scalars["heat"], [np.nan, 7, np.nan, 7])
        np.testing.assert_array_equal(points.scalars["age"], [np.inf, 8, np.inf, 8])
        np.testing.assert_array_equal(present(points.directions), np.ones((4, 3)))
        self.assertEqual(set(points.columns()), {"positions", "normals", "radii", "directions", "scalar heat", "scalar age"})
        self.assertEqual(encoded_bytes(block), encoded_bytes(raw_block(2)) + 2 * (12 + 4 + 4))
        self.assertEqual(decode_blocks([raw_block(2)]).scalars, {})

    def test_the_draco_decoder_is_there_where_it_was_built(self) -> None:
        self.assertEqual(curvecast.HAS_DRACO, WITH_DRACO)

    def test_a_draco_decoder_that_does_not_load_is_an_error(self) -> None:
        broken = """
import sys
class Broken:
    def find_spec(self, name, path=None, target=None):
        if name == "curvecast._draco":
            raise ImportError("undefined symbol")
sys.meta_path.insert(0, Broken())
import curvecast
"""
        self.assertIn("ImportError: undefined symbol", run_python(broken).stderr)
        missing = 'import sys; sys.modules["curvecast._draco"] = None; import curvecast; print(curvecast.HAS_DRACO)'
        self.assertEqual(run_python(missing).stdout, "False\n")

    @unittest.skipUnless(WITH_DRACO, "built without Draco")
    def test_claims_are_refused_before_they_cost_anything(self) -> None:
        # A point cloud of version 2.3, sequential, without metadata; then the number of points, and no more.
        header = b"DRACO\x02\x03\x00\x00\x00\x00"
        for count in (0xFFFFFFFF, 0x7FFFFFFF, MAX_POINTS + 1, 100_000, 3, 0):
            data = header + count.to_bytes(4, "little")
            block = v1.PointBlock(count=count, draco=v1.DracoPoints(data=data, radius_min=1, radius_max=2))
            self.assert_bad("Draco", block)
        for low, high in ((0, 1), (2, 1), (1, np.inf), (np.nan, 1)):
            self.assert_bad("radii", v1.PointBlock(count=3, draco=v1.DracoPoints(data=header, radius_min=low, radius_max=high)))

    def test_any_array_of_places(self) -> None:
        places = np.array([[1e6, 0, 0], [1e6 + 0.001, 1, 0]])
        np.testing.assert_allclose(as_points(places).world_positions(), places, atol=1e-7)
        self.assertEqual(len(as_points(np.zeros((0, 3)))), 0)
        for wrong in (np.zeros(3), np.zeros((3, 2)), [[[1, 2, 3]]]):
            with self.assertRaises(ValueError):
                as_points(wrong)


if __name__ == "__main__":
    unittest.main()
