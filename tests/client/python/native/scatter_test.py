"""Points straight on a mesh, in Python's own process."""

from __future__ import annotations

import os
import pathlib
import subprocess
import tempfile
import threading
import unittest
from typing import Any

import numpy as np
import numpy.testing
from shapes import cube, loosened, places, torus

import curvecast
from curvecast import density


def lie_on(vertices: Any, faces: Any, points: curvecast.Points) -> float:
    """How far points are from where their faces and weights say, at most."""
    assert points.faces is not None and points.barycentric is not None
    lie = places(vertices, faces, points.faces, points.barycentric)
    return float(np.abs(lie - points.world_positions()).max())


def areas(vertices: Any, faces: Any) -> Any:
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


class ScatterTest(unittest.TestCase):
    def test_every_face_has_its_share(self) -> None:
        for vertices, faces in (torus(), cube()):
            for points in (1, 500, 30_000):
                scattered = curvecast.scatter(vertices, faces, points, seed=2)
                self.assertEqual(len(scattered), points)
                assert scattered.faces is not None and scattered.normals is not None
                area = areas(vertices, faces)
                found = np.bincount(scattered.faces, minlength=len(faces))
                self.assertLess(np.abs(found - points * area / area.sum()).max(), 1 + 1e-6)
                self.assertLess(lie_on(vertices, faces, scattered), 1e-6)
                numpy.testing.assert_allclose(np.linalg.norm(scattered.normals, axis=1), 1, atol=1e-5)

    def test_faces_are_the_callers_own(self) -> None:
        vertices, faces = torus(30, 20)
        loose, own = loosened(vertices, faces)
        for rounds in (0, 3):
            points = curvecast.scatter(loose, own, 20_000, relaxation_rounds=rounds)
            self.assertLess(lie_on(loose, own, points), 2e-6)
            assert points.faces is not None
            self.assertGreater(len(np.unique(points.faces)), 0.99 * len(faces))

    def test_points_are_as_even_as_those_of_a_surface(self) -> None:
        vertices, faces = torus()
        surface = curvecast.Surface(vertices, faces)
        for rounds, rho in ((0, 0.0), (3, 0.6)):
            sets: list[Any] = [
                curvecast.scatter(vertices, faces, 8000, relaxation_rounds=rounds),
                surface.sample(8000, relaxation_rounds=rounds),
            ]
            ours, theirs = surface.measure(sets).sets
            self.assertLess(ours.ball_discrepancy.rms_relative, 1.2 * theirs.ball_discrepancy.rms_relative)
            self.assertLess(ours.ring_discrepancy.rms_relative, 1.2 * theirs.ring_discrepancy.rms_relative)
            self.assertGreaterEqual(ours.spacing.rho, rho)

    def test_normals_and_what_else_is_there_are_those_of_a_surface(self) -> None:
        vertices, faces = torus(200, 100)
        colours = np.where(vertices[:, 2:] > 0, [[250, 0, 0]], [[0, 0, 250]]).astype(np.uint8)
        points = curvecast.scatter(
            vertices,
            faces,
            5000,
            colours=colours,
            scalars={"height": vertices[:, 2]},
            attributes=["curvatures", "directions", "scalars"],
            relaxation_rounds=1,
        )
        assert points.normals is not None and points.radii is not None and points.curvatures is not None
        assert points.colours is not None and points.directions is not None
        at = points.world_positions()
        ring = at * [1, 1, 0] / np.linalg.norm(at[:, :2], axis=1, keepdims=True)
        numpy.testing.assert_allclose(points.normals, (at - ring) / 0.4, atol=0.01)
        numpy.testing.assert_allclose(points.curvatures[:, 1], 1 / 0.4, rtol=0.05)
        numpy.testing.assert_allclose(points.scalars["height"], at[:, 2], atol=1e-3)
        self.assertLess(np.abs((points.directions * points.normals).sum(axis=1)).max(), 1e-3)
        self.assertTrue((points.colours[at[:, 2] > 0.1, 0] > 240).all())
        numpy.testing.assert_allclose(points.radii, points.radii[0], rtol=1e-6)

    def test_points_of_a_file_are_those_of_the_command(self) -> None:
        vertices, faces = torus()
        with tempfile.TemporaryDirectory() as folder:
            mesh, out = pathlib.Path(folder) / "torus.obj", pathlib.Path(folder) / "points.npz"
            lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
            mesh.write_text("mtllib red.mtl\nusemtl red\n" + "\n".join(lines) + "\n")
            (pathlib.Path(folder) / "red.mtl").write_text("newmtl red\nKd 1 0 0\n")
            arguments = [
                os.environ["CURVECAST_COMMAND"],
                "sample",
                str(mesh),
                "-n",
                "5000",
                "--sampler",
                "scattered",
                "--relax",
                "2",
            ]
            arguments += ["--seed", "3", "--attributes", "surface,curvatures", "-o", str(out)]
            subprocess.run(arguments, check=True, capture_output=True)
            options: dict[str, Any] = {"relaxation_rounds": 2, "seed": 3, "attributes": ["surface", "curvatures", "rank"]}
            points = curvecast.scatter_file(mesh, 5000, **options)
            assert points.ranks is not None
            order = np.argsort(points.ranks)  # as the file has them
            with np.load(out) as written:
                for name in ("normals", "radii", "colours", "faces", "barycentric", "curvatures", "ranks"):
                    numpy.testing.assert_array_equal(points.columns()[name][order], written[name], name)
                numpy.testing.assert_allclose(points.world_positions()[order], written["positions"], atol=1e-6)
            assert points.colours is not None
            self.assertTrue((points.colours == [255, 0, 0]).all())
            plain = curvecast.scatter(vertices, faces, 5000, **options)
            numpy.testing.assert_array_equal(points.positions, plain.positions)
        with self.assertRaises(FileNotFoundError):
            curvecast.scatter_file(mesh, 10)

    def test_follows_a_density(self) -> None:
        vertices, faces = torus(200, 100)
        points = curvecast.scatter(
            vertices, faces, 20_000, scalars={"up": (vertices[:, 2] > 0).astype(float)}, density=density.attribute("up")
        )
        self.assertGreater(points.world_positions()[:, 2].min(), -0.05)
        self.assertLess(lie_on(vertices, faces, points), 1e-6)

    def test_the_same_in_any_case(self) -> None:
        vertices, faces = torus()
        wanted = curvecast.scatter(vertices, faces, 20_000, relaxation_rounds=2, seed=7, threads=1)
        found: list[curvecast.Points] = []
        threads = [
            threading.Thread(
                target=lambda: found.append(
                    curvecast.scatter(vertices, faces.astype(np.uint16), 20_000, relaxation_rounds=2, seed=7)
                )
            )
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 4)
        for points in found:
            for name, column in wanted.columns().items():
                numpy.testing.assert_array_equal(column, points.columns()[name], name)
        other = curvecast.scatter(vertices, faces, 20_000, relaxation_rounds=2, seed=8)
        self.assertFalse((other.positions == wanted.positions).all(axis=1).any())

    def test_far_from_the_origin(self) -> None:
        vertices, faces = torus()
        moved = vertices + np.array([4_512_345.678, 0, -98_765])
        self.assertLess(lie_on(moved, faces, curvecast.scatter(moved, faces, 1000, relaxation_rounds=2)), 2e-5)

    def test_what_cannot_be_done(self) -> None:
        vertices, faces = torus(6, 5)
        bad = vertices.copy()
        bad[7, 1] = np.nan
        for message, mesh in {
            r"mesh: vertices\[7, 1\] is nan": (bad, faces),
            r"faces\[0, 0\] is -1": (vertices, faces - 1),
            "no face with an area": (vertices, faces[:0]),
        }.items():
            with self.subTest(message), self.assertRaisesRegex(curvecast.Error, message):
                curvecast.scatter(*mesh, 100)
        with self.assertRaisesRegex(TypeError, "faces has values of type float64"):
            curvecast.scatter(vertices, faces.astype(float), 100)
        options: dict[str, dict[str, Any]] = {
            "points is 0": {"points": 0},
            "by their number": {"pixel_error": 2, "camera": curvecast.Camera((0, 0, 3))},
            "fixed ranks": {"points": 10, "sampler": "progressive"},
            "equal steps": {"points": 10, "sequence": "golden_ratio"},
            "relaxation_rounds": {"points": 10, "relaxation_rounds": 101},
            "crease_degrees": {"points": 10, "crease_degrees": -1},
            "no attribute 'none'": {"points": 10, "density": density.attribute("none")},
            "zero": {"points": 10, "scalars": {"none": np.zeros(30)}, "density": density.attribute("none")},
        }
        for message, given in options.items():
            with self.subTest(message), self.assertRaisesRegex(curvecast.Error, message):
                curvecast.scatter(vertices, faces, **given)

    def test_progress_is_told_and_may_end_the_work(self) -> None:
        vertices, faces = torus(600, 300)
        told: list[tuple[str, float]] = []
        curvecast.scatter(
            vertices, faces, 100_000, relaxation_rounds=2, on_progress=lambda stage, fraction: told.append((stage, fraction))
        )
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in told))
        self.assertGreater(len(told), 1)

        def stop(_stage: str, _fraction: float) -> None:
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            curvecast.scatter(vertices, faces, 100_000, relaxation_rounds=50, on_progress=stop)


if __name__ == "__main__":
    unittest.main()
