"""Edits of lists of points."""

import dataclasses
import json
import math
import os
import pathlib
import random
import unittest

import numpy as np
from google.protobuf import json_format

import curvecast
from curvecast.point_edits import apply_edits
from curvecast.points import Points
from curvecast.v1 import curvecast_pb2 as v1
from fixture import present


def numbered(numbers: list[int], ranked: bool = True) -> Points:
    """Points that are known by their numbers."""
    values = np.array(numbers, "<f4").reshape(-1, 1)
    return Points(
        np.zeros(3),
        values * np.array([[1, 2, -1]], "<f4"),
        normals=np.zeros((len(values), 3), "<f4"),
        radii=np.ones(len(values), "<f4"),
        ranks=np.array(numbers, "<u4") if ranked else None,
        scalars={"heat": np.array([3 * n for n in numbers], np.float32)},
    )


def steps(indices: list[int]) -> list[int]:
    return [i - before for before, i in zip([0, *indices], indices, strict=False)]


def listed(rows: list[tuple[int, int]], largest: float) -> Points:
    """Points of the shared cases, each by its number and the rung of its disc."""
    points = numbered([number for number, _ in rows])
    present(points.radii)[:] = [largest * 2 ** (-rung / 2) for _, rung in rows]
    return points


class PointEditsTest(unittest.TestCase):
    def test_the_shared_cases(self) -> None:
        path = pathlib.Path(os.environ["CURVECAST_SOURCE"]) / "tests" / "client" / "point_edits.json"
        cases = json.loads(path.read_text())
        self.assertGreater(len(cases), 30)
        for case in cases:
            with self.subTest(case["name"]):
                edits = json_format.ParseDict(case["edits"], v1.PointEdits())
                largest = edits.radius_max if 0 < edits.radius_max < math.inf else 1.0
                before, fresh = listed(case["before"], largest), listed(case["fresh"], largest)
                if case["after"] is None:
                    with self.assertRaises(curvecast.Error):
                        apply_edits(before, edits, fresh)
                    continue
                after, expected = apply_edits(before, edits, fresh), listed(case["after"], largest)
                np.testing.assert_array_equal(after.positions, expected.positions)
                np.testing.assert_array_equal(present(after.ranks), present(expected.ranks))
                np.testing.assert_allclose(present(after.radii), present(expected.radii), rtol=1e-6)

    def test_random_edits_give_the_new_list(self) -> None:
        chance = random.Random(1)
        numbers: list[int] = []
        held = numbered([])
        for turn in range(300):
            after: list[int] = []
            removed: list[int] = []
            places: list[int] = []
            fresh: list[int] = []
            kept_of_10, run = chance.randrange(11), chance.randrange(1, 6)
            for i in range(len(numbers) + 1):
                if chance.randrange(4) == 0:
                    for _ in range(chance.randrange(run + 1)):
                        fresh.append(1000 * turn + len(fresh))
                        places.append(len(after))
                        after.append(fresh[-1])
                if i == len(numbers):
                    break
                if chance.randrange(10) < kept_of_10 and len(after) < 500:
                    after.append(numbers[i])
                else:
                    removed.append(i)
            edits = v1.PointEdits(removed=steps(removed), added=steps(places))
            held = apply_edits(held, edits, numbered(fresh))
            numbers = after
            expected = numbered(numbers)
            np.testing.assert_array_equal(held.positions, expected.positions)
            np.testing.assert_array_equal(present(held.ranks), present(expected.ranks))
            np.testing.assert_array_equal(held.scalars["heat"], expected.scalars["heat"])
            self.assertEqual(len(present(held.radii)), len(numbers))

    def test_discs_climb_the_ladder(self) -> None:
        held = numbered([0, 1, 2, 3])
        # Point 1 twice larger, point 3 once smaller.
        climbed = apply_edits(held, v1.PointEdits(radius_max=8, resized=[2 * 1, 2 * 0, 2 * 2 + 1]), numbered([]))
        np.testing.assert_allclose(present(climbed.radii), [1, 2, 1, 2**-0.5], rtol=1e-6)
        np.testing.assert_array_equal(present(held.radii), 1)
        highest = apply_edits(held, v1.PointEdits(radius_max=8, resized=[2 * 2] + 50 * [0]), numbered([]))
        np.testing.assert_array_equal(present(highest.radii), [1, 1, 8, 1])

    def test_refuses_what_does_not_fit(self) -> None:
        held = numbered([0, 1, 2, 3])

        def refused(edits: v1.PointEdits, added: Points) -> None:
            with self.subTest(str(edits)), self.assertRaises(curvecast.Error) as caught:
                apply_edits(held, edits, added)
            self.assertEqual(caught.exception.code.name, "DATA_LOSS")

        largest = 2**32 - 1
        for removed in ([4], [3, 1], [1, 0], [0, largest, largest], [largest] * 1000):
            refused(v1.PointEdits(removed=removed), numbered([]))
        refused(v1.PointEdits(added=[5]), numbered([7]))
        refused(v1.PointEdits(added=[0]), numbered([]))
        refused(v1.PointEdits(), numbered([7]))
        refused(v1.PointEdits(added=[0, 0]), numbered([7, 8]))
        refused(v1.PointEdits(added=[0]), numbered([7], ranked=False))
        refused(v1.PointEdits(added=[0]), dataclasses.replace(numbered([7]), scalars={}))
        elsewhere = numbered([7])
        elsewhere.origin[1] = 3
        refused(v1.PointEdits(added=[0]), elsewhere)
        refused(v1.PointEdits(radius_max=1, resized=[8]), numbered([]))
        for radius in (0, -1, math.inf, math.nan):
            refused(v1.PointEdits(radius_max=radius, resized=[0]), numbered([]))
        self.assertEqual(len(apply_edits(held, v1.PointEdits(removed=[0], added=[0, 2]), numbered([7, 8]))), 5)


if __name__ == "__main__":
    unittest.main()
