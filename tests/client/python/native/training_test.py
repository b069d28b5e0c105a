"""Training sets, by the package that is installed."""

from __future__ import annotations

import os
import pathlib
import tempfile
import unittest
from typing import Any

import numpy as np
import numpy.testing
import numpy.typing as npt
from shapes import cube, places, torus, write_off

import curvecast
from curvecast import density


def spread(positions: npt.NDArray[Any]) -> float:
    """The least distance between two of the points."""
    return min(float(np.sort(np.linalg.norm(positions - p, axis=1))[1]) for p in positions)


class TrainingTest(unittest.TestCase):
    def test_prefixes_are_sets_of_their_own(self) -> None:
        surface = curvecast.Surface(*torus())
        even = curvecast.nested(surface, 4096, seed=2)
        for count in (128, 512, 2048):
            # No two much nearer than what a lattice would have: chance would give a few per cent of that.
            lattice = np.sqrt(surface.info.area / count * 2 / np.sqrt(3))
            self.assertGreater(spread(even.positions[:count]), 0.25 * lattice)
        curved = curvecast.nested(surface, 4096, density=density.curvature(), seed=2)
        self.assertEqual(len(curved), 4096)
        outside = np.linalg.norm(curved.world_positions()[:, :2], axis=1) > 1
        for count in (100, 256, 1000, 2048):
            self.assertAlmostEqual(outside[:count].mean(), outside.mean(), delta=0.03)

    def test_nothing_is_prepared_for_it(self) -> None:
        vertices, faces = torus()
        stages: set[str] = set()
        told: dict[str, Any] = {"on_progress": lambda stage, _: stages.add(stage)}
        bare, prepared = curvecast.Surface(vertices, faces, prepare=False, **told), curvecast.Surface(vertices, faces)
        self.assertLessEqual(stages, {"read", "repair"})
        numbers: dict[str, Any] = {"uniform": 500, "curved": 300, "features": 200, "near": 400, "space": 300}
        for name, column in curvecast.training_set(bare, seed=1, **numbers).arrays().items():
            numpy.testing.assert_array_equal(column, curvecast.training_set(prepared, seed=1, **numbers).arrays()[name], name)
        scattered = curvecast.scatter(vertices, faces, 700, seed=3)
        numpy.testing.assert_array_equal(scattered.positions, bare.scatter(700, seed=3).positions)
        numpy.testing.assert_array_equal(bare.sample(700, seed=3).positions, prepared.sample(700, seed=3).positions)
        self.assertEqual(bare.info, prepared.info)

    def test_seeds_tell_sets_apart(self) -> None:
        surface = curvecast.Surface(*cube())
        numbers: dict[str, Any] = {"uniform": 500, "curved": 300, "features": 200, "near": 400, "space": 300}
        one, again, other = (curvecast.training_set(surface, seed=seed, **numbers).arrays() for seed in (1, 1, 2))
        fresh = curvecast.training_set(curvecast.Surface(*cube(), threads=1), seed=1, **numbers).arrays()
        for name, column in one.items():
            numpy.testing.assert_array_equal(column, again[name], name)
            numpy.testing.assert_array_equal(column, fresh[name], name)
        for name in ("uniform_positions", "features_positions", "near_positions", "space_positions"):
            self.assertFalse(np.array_equal(one[name], other[name]), name)

    def test_a_cubes_edges_and_distances(self) -> None:
        vertices, faces = cube()
        surface = curvecast.Surface(vertices, faces)
        made = curvecast.training_set(surface, features=1200, near=3000, space=3000, seed=4)
        assert made.features is not None and made.near is not None and made.space is not None
        self.assertAlmostEqual(made.features.length, 12)
        on = made.features.points.world_positions()
        self.assertTrue(((np.abs(np.abs(on) - 0.5) < 1e-6).sum(axis=1) >= 2).all())
        assert made.features.points.faces is not None and made.features.points.barycentric is not None
        lie = places(vertices, faces, made.features.points.faces, made.features.points.barycentric)
        self.assertLess(np.abs(lie - on).max(), 1e-6)
        sides = made.features.side_normals
        numpy.testing.assert_allclose((sides[:, 0] * sides[:, 1]).sum(axis=1), 0, atol=1e-6)
        for given in (made.near, made.space):
            q = np.abs(given.positions) - 0.5
            exact = np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)
            numpy.testing.assert_allclose(given.signed_distance, exact, atol=1e-12)
            numpy.testing.assert_array_equal(given.occupancy, exact < 0)
        self.assertTrue(0.3 < made.near.occupancy.mean() < 0.7)
        self.assertGreater(np.abs(made.space.positions).max(), 0.55)

    def test_every_face_has_its_points(self) -> None:
        vertices, faces = torus(40, 30)
        faces = np.where((np.arange(len(faces)) % 7 == 0)[:, None], faces[:, [0, 2, 1]], faces)  # some look the other way
        surface = curvecast.Surface(vertices, faces)
        made = curvecast.training_set(surface, uniform=1000, n_per_face=3, seed=1).uniform
        assert made is not None and made.faces is not None and made.barycentric is not None
        self.assertGreaterEqual(np.bincount(made.faces, minlength=len(faces)).min(), 3)
        lie = places(vertices, faces, made.faces, made.barycentric)
        self.assertLess(np.abs(lie - made.world_positions()).max(), 1e-5)
        first = curvecast.training_set(surface, uniform=1000, seed=1).uniform
        assert first is not None
        numpy.testing.assert_array_equal(made.positions[:1000], first.positions)

    def test_open_meshes_have_no_inside(self) -> None:
        vertices, faces = torus()
        with self.assertRaisesRegex(curvecast.Error, "no inside"):
            curvecast.training_set(curvecast.Surface(vertices, faces[2:]), near=10)
        with self.assertRaisesRegex(ValueError, "uniform is -1"):
            curvecast.training_set(curvecast.Surface(vertices, faces), uniform=-1)

    def test_files_of_numpy(self) -> None:
        made = curvecast.training_set(curvecast.Surface(*torus()), uniform=200, features=10, near=50)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "set.npz")
            made.save(path)
            with np.load(path) as arrays:
                self.assertEqual(arrays["uniform_positions"].shape, (200, 3))
                self.assertEqual(arrays["near_occupancy"].dtype, bool)
                self.assertEqual(arrays["features_positions"].shape, (0, 3))  # a torus is smooth


class TorchTest(unittest.TestCase):
    def test_data_sets(self) -> None:
        try:
            import torch
            from torch.utils.data import DataLoader
        except ModuleNotFoundError:
            self.skipTest("there is no torch here")
        from curvecast.torch import MeshPoints, ShardedMeshPoints

        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for i in range(6):
                paths.append(os.path.join(folder, f"{i}.off"))
                write_off(paths[-1], *torus(20 + i, 10))
            data = MeshPoints(paths, uniform=64, near=32, cache=os.path.join(folder, "sets"))
            plain = MeshPoints(paths, uniform=64, near=32)[3]
            for _ in range(2):  # made, then kept
                kept = data[3]
                self.assertEqual(kept["uniform_positions"].dtype, torch.float32)
                self.assertEqual(kept["uniform_faces"].dtype, torch.int64)
                for name in ("uniform_positions", "near_signed_distance"):
                    self.assertTrue(torch.equal(kept[name], plain[name]))
            loaded = list(DataLoader(data, batch_size=3, num_workers=2))
            self.assertEqual([tuple(batch["uniform_positions"].shape) for batch in loaded], [(3, 64, 3)] * 2)
            seen: list[int] = []
            for shard in range(2):
                sharded = ShardedMeshPoints(data, shard, 2)
                seen += [int(sample["index"]) for sample in DataLoader(sharded, batch_size=None, num_workers=2)]
            self.assertEqual(sorted(seen), list(range(6)))
            data.set_epoch(1)
            self.assertFalse(torch.equal(data[3]["uniform_positions"], plain["uniform_positions"]))
            self.assertEqual(len(list(pathlib.Path(folder, "sets").glob("*.npz"))), 7)


if __name__ == "__main__":
    unittest.main()
