"""Meshes and sessions of a real server."""

import time
import unittest
from typing import Any

import numpy as np
import numpy.typing as npt

import curvecast
from curvecast.protocol import MAX_POINTS
from curvecast.v1 import curvecast_pb2 as v1
from fixture import WITH_DRACO, ServerTest, present, sphere_obj


class ClientTest(ServerTest):
    def write(self, name: str, text: str) -> str:
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return str(path)

    def test_a_mesh_is_sent_once(self) -> None:
        path = self.write("once.obj", sphere_obj(150))
        told: list[tuple[str, float]] = []
        mesh = self.client.upload(path, lambda *progress: told.append(progress))
        self.assertGreater(len(told), 1)
        self.assertEqual({stage for stage, _ in told}, {"upload"})
        fractions = [fraction for _, fraction in told]
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(fractions[-1], 1)
        told.clear()
        self.assertEqual(self.client.upload(path, lambda *progress: told.append(progress)), mesh)
        self.assertEqual(told, [])
        self.assertEqual(self.client.upload_bytes("other name.obj", (self.folder / "once.obj").read_bytes()).id, mesh.id)

    def test_files_that_cannot_be_read(self) -> None:
        with self.assertRaises(FileNotFoundError):
            self.client.upload(self.folder / "nowhere.obj")
        with self.assertRaises(IsADirectoryError):
            self.client.upload(self.folder)
        self.assert_refused("INVALID_ARGUMENT", "empty", self.client.upload, self.write("empty.obj", ""))

    def test_companions_come_along(self) -> None:
        self.write("red/red.mtl", "newmtl red\nKd 1 0 0\nmap_Kd link.png\n")
        (self.folder / "red" / "link.png").symlink_to(self.write("secret.png", "secret"))
        path = self.write("red/red.obj", "mtllib red.mtl\nmtllib missing.mtl\nusemtl red\n" + sphere_obj(8))
        mesh = self.client.upload(path)
        self.assertEqual(list(mesh.companions), ["red.mtl"])
        self.assertEqual(len(mesh.refused), 1)
        self.assertIn("link.png", mesh.refused[0])
        warnings = "\n".join(self.client.inspect(mesh).warnings)
        self.assertIn("missing.mtl", warnings)
        self.assertIn(mesh.refused[0], warnings)
        for encoding in ("raw", "draco") if WITH_DRACO else ("raw",):
            points = self.client.open(mesh, 100).sample(100, encoding=encoding)
            np.testing.assert_array_equal(present(points.colours), np.tile(np.array([255, 0, 0], np.uint8), (100, 1)))

    def test_what_a_mesh_holds(self) -> None:
        info = self.client.inspect(self.client.upload(self.write("info.obj", sphere_obj(24))))
        self.assertEqual((info.format, info.components, info.genus, info.boundary_loops), ("obj", 1, 0, 0))
        self.assertAlmostEqual(info.area, 4 * np.pi, delta=0.1)

    def test_meshes(self) -> None:
        text = sphere_obj(5)
        mesh = self.client.upload(self.write("listed.obj", text))
        listed = {stored.mesh_id: stored for stored in self.client.meshes()}
        self.assertEqual((listed[mesh.id].name, listed[mesh.id].size), ("listed.obj", len(text)))
        self.assertEqual(list(listed), sorted(listed))

    def test_points_without_a_session(self) -> None:
        mesh = self.client.upload(self.write("scattered.obj", sphere_obj(40)))
        sessions = len(self.client.sessions())
        stages: set[str] = set()
        options: dict[str, Any] = {"relaxation_rounds": 2, "attributes": ["surface"], "seed": 3}
        points = self.client.scatter(mesh, 30_000, on_progress=lambda stage, _: stages.add(stage), **options)
        self.assertEqual(len(points), 30_000)
        self.assertEqual(present(points.faces).shape, (30_000,))
        np.testing.assert_allclose(np.linalg.norm(points.world_positions(), axis=1), 1, atol=0.02)
        self.assertLessEqual(stages, {"queued", "read", "repair", "scatter", "relax", "order"})
        self.assertFalse(points.statistics.refining)
        self.assert_same_points(points, self.client.scatter(mesh.id, 30_000, **options))
        if WITH_DRACO:
            self.assertEqual(len(self.client.scatter(mesh, 500, encoding="draco")), 500)
        camera = curvecast.Camera((0, 0, 5))
        near = self.client.scatter(mesh, 500, density=[curvecast.density.view()], camera=camera)
        self.assertGreater(near.world_positions()[:, 2].mean(), 0.2)
        self.assertEqual(len(self.client.sessions()), sessions)
        self.assert_refused("NOT_FOUND", "0" * 32, self.client.scatter, "0" * 32, 10)
        self.assert_refused("INVALID_ARGUMENT", "fixed ranks", self.client.scatter, mesh, 10, sampler="progressive")
        self.assert_refused("INVALID_ARGUMENT", "crease_degrees", self.client.scatter, mesh, 10, crease_degrees=-1)

    def test_sessions(self) -> None:
        mesh = self.client.upload(self.write("sessions.obj", sphere_obj(16)))
        stages: set[str] = set()
        session = self.client.open(
            mesh, 500, density=[curvecast.density.curvature()], on_progress=lambda stage, _: stages.add(stage)
        )
        self.assertEqual(session.info.state, v1.SESSION_STATE_READY)
        self.assertLessEqual(stages, {"queued", "load", "read", "repair", "cut", "parameterise", "curve", "map", "area", "ranks"})
        self.assertEqual(self.client.open(mesh.id, 500, density=[curvecast.density.curvature()]).id, session.id)
        self.assertNotEqual(self.client.open(mesh, 501).id, session.id)
        self.assertFalse(session.info.options.HasField("crease_degrees"))
        flat = self.client.open(mesh, 500, density=[curvecast.density.curvature()], crease_degrees=0)
        self.assertNotEqual(flat.id, session.id)
        self.assertEqual(flat.info.options.crease_degrees, 0)
        self.assert_refused("INVALID_ARGUMENT", "options.crease_degrees", self.client.open, mesh, crease_degrees=180.5)
        self.assertIn(session.id, [other.id for other in self.client.sessions()])
        self.assertEqual(self.client.session(session.id).info.mesh_id, mesh.id)
        self.assertTrue(session.update(pinned=True).pinned)
        self.assertEqual(session.update(time_to_live=1000).time_to_live, 1000)
        self.assertTrue(session.update(pinned=None).pinned)
        self.assert_refused("INVALID_ARGUMENT", "", session.update, time_to_live=-1)
        session.close()
        self.assertNotIn(session.id, [other.id for other in self.client.sessions()])
        self.assert_refused("NOT_FOUND", session.id, session.refresh)
        self.assert_refused("NOT_FOUND", session.id, session.sample, 10)
        self.assert_refused("NOT_FOUND", session.id, session.close)

    def test_refusals(self) -> None:
        nothing = "0" * 32
        self.assert_refused("NOT_FOUND", nothing, self.client.inspect, nothing)
        self.assert_refused("NOT_FOUND", nothing, self.client.open, nothing)
        self.assert_refused("NOT_FOUND", "", self.client.session, "no such session")
        self.assert_refused("PERMISSION_DENIED", "", self.client.import_mesh, "mesh.obj")
        broken = self.client.upload(self.write("broken.obj", "v 0 0 0\nf 1 2 3\n"))
        self.assert_refused("INVALID_ARGUMENT", "line 2", self.client.open, broken)
        mesh = self.client.upload(self.write("refusals.obj", sphere_obj(8)))
        self.assert_refused("INVALID_ARGUMENT", "", self.client.open, mesh, MAX_POINTS + 1)
        self.assert_refused("NOT_FOUND", "", self.client.open, curvecast.Mesh(mesh.id, {"a.mtl": nothing}))
        wrong: tuple[dict[str, Any], ...] = ({"mapper": "best"}, {"area": "some"}, {"parameteriser": "unspecified"})
        for options in wrong:
            with self.assertRaises(ValueError):
                self.client.open(mesh, **options)

    def test_an_exception_stops_preprocessing(self) -> None:
        mesh = self.client.upload(self.write("cancel.obj", sphere_obj(200)))
        before = {session.id for session in self.client.sessions()}

        def stop(*_: object) -> None:
            raise InterruptedError("enough")

        with self.assertRaises(InterruptedError):
            self.client.open(mesh, 100_000, on_progress=stop)
        while {session.id for session in self.client.sessions()} - before:  # the server may take a moment
            time.sleep(0.01)
        self.assertEqual(self.client.open(mesh, 1000).info.mesh_id, mesh.id)

    def test_measures(self) -> None:
        mesh = self.client.upload(self.write("measures.obj", sphere_obj(24)))
        sampled = self.client.open(mesh, 4096).sample(4096)
        random = np.random.default_rng(1).normal(size=(1024, 3))
        random /= np.linalg.norm(random, axis=1, keepdims=True)
        both: list[curvecast.Points | npt.NDArray[np.float64]] = [sampled, random]
        even, uneven = self.client.measure(mesh, both).sets
        self.assertEqual((even.points, uneven.points), (4096, 1024))
        self.assertLess(even.on_surface.max, 0.01)
        self.assertLess(even.ball_discrepancy.rms_relative, 0.5)
        self.assertGreater(uneven.ball_discrepancy.rms_relative, 0.5)
        alone = self.client.measure(mesh, sampled.world_positions()).sets
        self.assertEqual(alone[0].points, 4096)
        self.assert_refused("INVALID_ARGUMENT", "", self.client.measure, mesh, np.zeros((1, 3)))
        self.assert_refused("INVALID_ARGUMENT", "", self.client.measure, mesh, [])
        coarse = self.client.upload(self.write("coarse.obj", sphere_obj(12)))
        distance = self.client.measure(mesh, other=coarse, distance_samples=10_000).distance
        self.assertAlmostEqual(distance.diagonal, 2 * np.sqrt(3), delta=0.05)
        self.assertEqual(distance.max, max(distance.from_mesh.max, distance.from_other.max))
        self.assertTrue(0.1 < distance.from_mesh.mean < distance.from_mesh.rms < distance.max < 1.5, distance)
        self.assertLess(self.client.measure(mesh, other=mesh).distance.max, 1e-5)

    def test_a_client_that_hangs_up(self) -> None:
        with curvecast.connect(self.server.address) as client:
            client.sessions()
        with self.assertRaises(ValueError):
            client.sessions()


if __name__ == "__main__":
    unittest.main()
