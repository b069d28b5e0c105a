"""Point sets of a real server."""

import dataclasses
import unittest
from typing import ClassVar

import numpy as np

import curvecast
from curvecast import Camera, View, density
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1
from fixture import WITH_DRACO, ServerTest, eye_at, present, sphere_obj, tube_ply

RINGS = 24
CENTRE, RADIUS = (1000, -2000, 3000), 5


class SessionTest(ServerTest):
    mesh: ClassVar[curvecast.Mesh]
    session: ClassVar[curvecast.Session]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.mesh = cls.client.upload_bytes("ball.obj", sphere_obj(RINGS).encode())
        cls.session = cls.client.open(cls.mesh, 4096)

    def test_exactly_as_many_points(self) -> None:
        for count in (1, 2, 3, 17, 1000, 4096):
            for sampler in ("equalised", "progressive"):
                points = self.session.sample(count, sampler=sampler)
                self.assertEqual(len(points), count)
                self.assertEqual(points.positions.shape, (count, 3))
                self.assertEqual(present(points.normals).shape, (count, 3))
                self.assertEqual(present(points.radii).shape, (count,))

    def test_the_same_request_gives_the_same_points(self) -> None:
        for view in (View(1000), View(1000, sequence="golden_ratio", seed=3), View(1000, sampler="progressive")):
            one, other = self.session.sample(view), self.session.sample(view)
            self.assert_same_points(one, other)
            np.testing.assert_array_equal(present(one.radii), present(other.radii))
        self.assertFalse(np.array_equal(self.session.sample(1000, seed=1).positions, self.session.sample(1000, seed=2).positions))

    def test_niederreiter_is_another_name_of_van_der_corput(self) -> None:
        one, other = (View(10, sequence=name).to_proto() for name in ("niederreiter", "van_der_corput"))
        self.assertEqual(one, other)
        self.assertEqual(one.sequence, v1.SEQUENCE_VAN_DER_CORPUT)
        with self.assertRaisesRegex(ValueError, "jittered, regular, van_der_corput"):
            View(10, sequence="halton").to_proto()

    def test_the_progressive_samplers_seed_is_the_sessions(self) -> None:
        mesh = self.client.upload_bytes("seeded.obj", sphere_obj(8).encode())
        one, other = (self.client.open(mesh, 1000, seed=seed) for seed in (0, 1))
        self.assertNotEqual(one.id, other.id)
        first, second = (session.sample(500, sampler="progressive").positions for session in (one, other))
        self.assertFalse(np.array_equal(first, second))

    def test_streams_use_the_progressive_sampler(self) -> None:
        for view, in_stream, expected in (
            (View(10), False, v1.SAMPLER_EQUALISED),
            (View(10), True, v1.SAMPLER_PROGRESSIVE),
            (View(10, attributes=["rank"]), False, v1.SAMPLER_PROGRESSIVE),
            (View(10, sequence="regular"), True, v1.SAMPLER_EQUALISED),
            (View(10, sampler="equalised"), True, v1.SAMPLER_EQUALISED),
        ):
            with self.subTest(view, in_stream=in_stream):
                self.assertEqual(view.to_proto(in_stream).sampler, expected)

    def test_points_lie_on_the_sphere(self) -> None:
        mesh = self.client.upload_bytes("far.obj", sphere_obj(RINGS, RADIUS, CENTRE).encode())
        points = self.client.open(mesh, 4096).sample(4096)
        away = points.world_positions() - CENTRE
        distances = np.linalg.norm(away, axis=1)
        sagitta = 1 - np.cos(np.pi / 2 / RINGS) ** 2  # of the quads, about
        self.assertLess(distances.max(), RADIUS * (1 + 1e-5))
        self.assertGreater(distances.min(), RADIUS * (1 - 1.1 * sagitta))
        np.testing.assert_allclose(np.linalg.norm(present(points.normals), axis=1), 1, atol=1e-4)
        self.assertGreater((present(points.normals) * away / distances[:, None]).sum(axis=1).min(), 0.99)
        # Discs overlap a little, so their areas add up to more than the sphere's.
        self.assertGreater((np.pi * present(points.radii).astype(float) ** 2).sum(), 4 * np.pi * RADIUS**2)
        np.testing.assert_allclose(away.mean(axis=0), 0, atol=0.02 * RADIUS)

    def test_remesh_closes_the_sphere(self) -> None:
        mesh = self.session.remesh(1000, density=density.expression("1 + 3 * (y > 0)"), sampler="progressive")
        self.assertEqual(len(mesh.vertices), 1000)
        self.assertEqual(len(mesh), 1996)
        self.assertEqual((mesh.info.components, mesh.info.genus, mesh.info.boundary_loops), (1, 0, 0))
        sides = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
        self.assertEqual({tuple(side) for side in sides.tolist()}, {tuple(side) for side in sides[:, ::-1].tolist()})
        corners = mesh.vertices.world_positions()[mesh.triangles]
        volume = np.linalg.det(corners).sum() / 6
        self.assertAlmostEqual(volume, 4 / 3 * np.pi, delta=0.2)
        self.assertEqual(len(present(mesh.vertices.faces)), 1000)
        self.assertEqual(len(self.session.remesh(View(points=500), relaxations=0)), 996)
        self.assertGreater(mesh.info.angles.median, 45)
        self.assertEqual(len(self.session.remesh(1000, method="parameter")), 1996)
        with self.assertRaises(ValueError):
            self.session.remesh(1000, method="magic")
        fitted = self.session.remesh(1000, fit=True, feature_degrees=60)
        self.assertGreaterEqual(fitted.info.angles.least, 20)
        with self.assertRaises(curvecast.Error):
            self.session.remesh(3)

    def test_density_moves_points(self) -> None:
        north = density.expression("1 + 3 * (y > 0)")
        points = self.session.sample(4000, density=north)
        self.assertAlmostEqual((points.positions[:, 1] > 0).mean(), 0.8, delta=0.02)
        both = self.session.sample(4000, density=[north, density.expression("y < 0")])
        self.assertLess(both.positions[:, 1].max(), 0.1)

    def test_every_term(self) -> None:
        camera = Camera(eye_at(30, 4), fov=30)
        terms = [
            density.uniform(),
            density.curvature("mean", exponent=2, floor=0.5),
            density.brush((0, 1, 0), 0.5, 9, falloff=1),
            density.brush([(0, 1, 0), (0, 0, 1), (1, 0, 0)], 0.5, 9),
            density.paint(density.brush((0, 1, 0), 2, 0), density.brush((0, 1, 0), 1, 1)),
            density.view(),
            density.view(0.5),
            density.distance(),
            density.distance(1, 9),
            density.frustum(),
            density.screen(),
        ]
        for term in terms:
            points = self.session.sample(500, density=[term], camera=camera, viewport=(640, 480), patience=60)
            self.assertEqual(len(points), 500, term)
        facing = self.session.sample(500, density=density.view(), camera=camera)
        self.assertGreater((present(facing.normals) * (np.array(camera.eye) - facing.positions)).sum(axis=1).min(), -0.1)
        linear = density.distance(1, 9, whole=True, fall="linear")
        self.assertLess(len(self.session.sample(500, density=linear, camera=camera)), 500)
        fewer = self.session.sample(500, density=density.distance(whole=True, near=1), camera=camera)
        self.assertLess(len(fewer), 500)
        self.assert_refused("INVALID_ARGUMENT", "temperature", self.session.sample, 10, density=density.attribute("temperature"))
        with self.assertRaises(ValueError):
            density.curvature("most")

    def test_attributes(self) -> None:
        points = self.session.sample(2000, sampler="progressive", attributes=["rank", "curvatures", "surface"])
        self.assertEqual(len(np.unique(present(points.ranks))), 2000)
        self.assertEqual(present(points.curvatures).shape, (2000, 2))
        self.assertTrue((np.diff(present(points.curvatures), axis=1) >= 0).all())
        self.assertLess(present(points.faces).max(), self.session.info.report.mesh.file_polygons)
        self.assertGreaterEqual(present(points.barycentric).min(), -1e-5)
        self.assertLessEqual(present(points.barycentric).sum(axis=1).max(), 1 + 1e-5)
        fewer = self.session.sample(500, sampler="progressive", attributes=["rank"])
        self.assertLessEqual(set(present(fewer.ranks)), set(present(points.ranks)))
        self.assertIsNone(fewer.faces)
        self.assert_refused("INVALID_ARGUMENT", "", self.session.sample, 10, attributes=["rank"], sampler="equalised")

    def test_directions_and_named_values(self) -> None:
        session = self.client.open(self.client.upload_bytes("tube.ply", tube_ply().encode()), 2000)
        for view in (View(500), View(500, sampler="progressive"), View(8000, sampler="progressive")):
            points = session.sample(view, attributes=["directions", "scalars"])
            x, y, z = points.world_positions().T
            self.assertEqual(set(points.scalars), {"heat", "age"})
            np.testing.assert_allclose(points.scalars["heat"], 2 * x - y + z, atol=1e-4)
            self.assertEqual(points.scalars["age"].shape, (len(points),))
            # A tube bends around its axis, and not along it.
            directions = present(points.directions)
            np.testing.assert_allclose(np.abs(directions[:, 2]), 1, atol=0.01)
            around = np.cross(present(points.normals), directions)
            np.testing.assert_allclose(np.abs(around[:, 0] * y - around[:, 1] * x), np.hypot(x, y), atol=0.05)
        self.assertEqual(session.sample(10).scalars, {})

    def test_points_move_apart(self) -> None:
        def nearest(points: curvecast.Points) -> float:
            p = points.world_positions()
            return min(float(np.sort(np.linalg.norm(p - p[i], axis=1))[1]) for i in range(len(p)))

        attributes = ["curvatures", "directions", "surface"]
        still = self.session.sample(1500, attributes=attributes)
        apart = self.session.sample(1500, attributes=attributes, relaxation_rounds=10)
        packed = np.sqrt(2 / np.sqrt(3) * 4 * np.pi / 1500)
        self.assertLess(nearest(still), 0.3 * packed)
        self.assertGreater(nearest(apart), 0.6 * packed)
        self.assertLess(np.abs(np.linalg.norm(apart.world_positions(), axis=1) - 1).max(), 0.01)
        # Attributes are those of the places where points have moved to.
        np.testing.assert_allclose(np.median(present(apart.curvatures), axis=0), 1, atol=0.02)  # coarse triangles at the poles
        turned = np.abs(np.einsum("ij,ij->i", present(apart.directions), present(apart.normals)))
        self.assertLess(turned.max(), 0.01)
        np.testing.assert_array_equal(
            apart.positions, self.session.sample(1500, attributes=attributes, relaxation_rounds=10).positions
        )
        self.assert_refused("INVALID_ARGUMENT", "relaxation_rounds", self.session.sample, 10, relaxation_rounds=101)
        ranked = View(10, sampler="progressive", relaxation_rounds=1)
        self.assert_refused("INVALID_ARGUMENT", "equalised", self.session.sample, ranked)
        with self.session.stream() as stream:
            stream.send(View(10, relaxation_rounds=1))
            refused = stream.frame().error
            assert refused is not None
            self.assertIn("not for streams", str(refused))

    @unittest.skipUnless(WITH_DRACO, "built without Draco")
    def test_draco_rounds(self) -> None:
        view = View(3000, sampler="progressive", attributes=["rank"])
        raw = self.session.sample(view)
        for bits in (8, 11, 16):
            draco = self.session.sample(view, encoding="draco", position_bits=bits)
            np.testing.assert_array_equal(present(draco.ranks), present(raw.ranks))
            np.testing.assert_allclose(draco.world_positions(), raw.world_positions(), atol=2 / (2**bits - 1))
            self.assertGreater((present(draco.normals) * present(raw.normals)).sum(axis=1).min(), 0.999)
            np.testing.assert_allclose(present(draco.radii), present(raw.radii), rtol=0.05)

    def test_other_budgets(self) -> None:
        camera = Camera(eye_at(0, 3))
        coarse = self.session.sample(pixel_error=60, camera=camera)
        fine = self.session.sample(pixel_error=30, camera=camera)
        self.assertGreater(len(fine), 2 * len(coarse))
        self.assertLessEqual(28 * len(self.session.sample(max_bytes=28_000)), 28_000)

    def test_ranked_points_go_deeper_than_the_curve(self) -> None:
        session = self.client.open(self.mesh, 100)
        points = session.sample(50_000, sampler="progressive", density=density.view(), camera=Camera((0, 0, 1.03)))
        self.assertEqual(len(points), 50_000)
        self.assertIsNone(points.limit)

    def test_patience(self) -> None:
        session = self.client.open(self.mesh, 300)
        points = session.sample(30_000, patience=120)
        self.assertEqual(len(points), 30_000)
        self.assertFalse(points.statistics.refining)
        self.assertGreater(session.info.curve_revision, 1)

    def test_views_that_make_no_sense(self) -> None:
        for options in (
            {},
            {"points": 10, "max_bytes": 5000},
            {"points": 10, "sampler": "best"},
            {"points": 10, "sequence": "x"},
            {"points": 10, "attributes": ["weight"]},
            {"points": 10, "encoding": "zip"},
        ):
            with self.subTest(options), self.assertRaises(ValueError):
                self.session.sample(View(**options))
        with self.assertRaises(TypeError):
            self.session.sample(10, colour="red")
        self.assert_refused("INVALID_ARGUMENT", "", self.session.sample, 0)
        self.assert_refused("OUT_OF_RANGE", "", self.session.sample, MAX_POINTS + 1)
        self.assert_refused("INVALID_ARGUMENT", "", self.session.sample, 10, density=density.view())
        refused = self.assert_refused("INVALID_ARGUMENT", "", self.session.sample, 10, camera=Camera((1e400, 0, 0)))
        self.assertEqual(list(refused.fields), ["sample.cameras[0].eye.x"])
        self.assert_refused("INVALID_ARGUMENT", "", self.session.sample, 10, camera=Camera((0, 0, 0)), density=density.view())
        self.assert_refused("FAILED_PRECONDITION", "", self.session.sample, 10, density=density.expression("0"))
        self.assertEqual(dataclasses.replace(View(10), seed=2).to_proto().seed, 2)


if __name__ == "__main__":
    unittest.main()
