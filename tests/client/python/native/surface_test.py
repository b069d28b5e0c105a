"""Surfaces in Python's own process, by the package that is installed."""

from __future__ import annotations

import gc
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from typing import Any

import numpy as np
import numpy.testing
from shapes import loosened, places, torus, write_off

import curvecast
from curvecast import Camera, View, density

COMMAND = os.environ["CURVECAST_COMMAND"]
COLUMNS = ["positions", "normals", "radii"]


def present(column: Any) -> Any:
    assert column is not None
    return column


def same(a: curvecast.Points, b: curvecast.Points) -> None:
    assert a.columns().keys() == b.columns().keys()
    for name, column in a.columns().items():
        numpy.testing.assert_array_equal(column, b.columns()[name], name)


class SurfaceTest(unittest.TestCase):
    surface: curvecast.Surface

    @classmethod
    def setUpClass(cls) -> None:
        cls.surface = curvecast.Surface(*torus())

    def test_points_are_those_of_the_command(self) -> None:
        vertices, faces = torus()
        with tempfile.TemporaryDirectory() as folder:
            mesh, out = os.path.join(folder, "torus.off"), os.path.join(folder, "points.ply")
            write_off(mesh, vertices, faces)
            of_file = curvecast.read(mesh)
            cases: list[tuple[dict[str, Any], list[str]]] = [
                ({"density": density.curvature(), "seed": 3}, ["--density", "curvature", "--seed", "3"]),
                ({"sampler": "progressive"}, ["--sampler", "progressive"]),
                ({"relaxation_rounds": 3}, ["--relax", "3"]),
            ]
            for options, flags in cases:
                flags += ["--attributes", "surface", "-n", "30000", "-o", out, "--quiet", "--no-cache"]
                subprocess.run([COMMAND, "sample", mesh, *flags], check=True, timeout=120, stdout=subprocess.DEVNULL)
                written = read_ply(out)
                for surface in (self.surface, of_file):
                    points = surface.sample(30_000, attributes=["surface"], **options)
                    numpy.testing.assert_array_equal(points.positions, np.stack([written[axis] for axis in "xyz"], axis=1))
                    numpy.testing.assert_array_equal(present(points.radii), written["radius"])
                    numpy.testing.assert_array_equal(present(points.faces), written["face"])

    def test_faces_are_the_callers_own(self) -> None:
        vertices, faces = torus(30, 20)
        loose, own = loosened(vertices, faces)
        points = curvecast.Surface(loose, own).sample(20_000, attributes=["surface"])
        assert points.faces is not None and points.barycentric is not None
        lie = places(loose, own, points.faces, points.barycentric)
        self.assertLess(np.abs(lie - points.world_positions()).max(), 2e-5)
        self.assertGreater(len(np.unique(points.faces)), 0.99 * len(faces))

    def test_nothing_depends_on_threads_or_on_what_was_asked_before(self) -> None:
        vertices, faces = torus()
        fresh = curvecast.Surface(vertices, faces, threads=1)
        for options in ({"points": 3000}, {"points": 20_000}, {"points": 20_000, "sampler": "progressive"}):
            same(fresh.sample(**options), self.surface.sample(**options))
        fresh.sample(200_000)
        same(fresh.sample(3000), self.surface.sample(3000))

    def test_even_where_more_points_are_asked_for_than_the_curve_was_made_for(self) -> None:
        vertices, faces = torus(20, 20)
        points = curvecast.Surface(vertices, faces, points=1000).sample(100_000)
        self.assertEqual(len(np.unique(points.positions, axis=0)), 100_000)

    def test_arrays_of_all_sorts(self) -> None:
        vertices, faces = torus(20, 10)
        wanted = curvecast.Surface(vertices, faces).sample(500)
        strided = np.zeros((len(vertices), 6))
        strided[:, ::2] = vertices
        for given in [
            (vertices.tolist(), faces.tolist()),
            (np.asfortranarray(vertices), faces.astype(np.uint16)),
            (strided[:, ::2], faces.astype(">i4")),
        ]:
            same(curvecast.Surface(*given).sample(500), wanted)
        half = vertices.astype(np.float32)
        same(curvecast.Surface(half, faces).sample(500), curvecast.Surface(half.astype(np.float64), faces).sample(500))

    def test_colours_and_numbers_come_along(self) -> None:
        vertices, faces = torus()
        colours = np.where(vertices[:, 2:] > 0, [[250, 0, 0]], [[0, 0, 250]]).astype(np.uint8)
        surface = curvecast.Surface(vertices, faces, colours=colours, scalars={"height": vertices[:, 2]})
        points = surface.sample(5000, attributes=["scalars", "curvatures", "directions"], density=density.attribute("height"))
        assert points.colours is not None and points.curvatures is not None and points.directions is not None
        self.assertEqual(points.curvatures.shape, (5000, 2))
        numpy.testing.assert_allclose(points.scalars["height"], points.positions[:, 2], atol=2e-3)
        self.assertGreater(points.positions[:, 2].min(), -0.05)
        self.assertTrue((points.colours[points.positions[:, 2] > 0.1, 0] > 240).all())

    def test_far_from_the_origin(self) -> None:
        vertices, faces = torus()
        moved = vertices + np.array([4_512_345.678, 0, -98_765])
        points = curvecast.Surface(moved, faces).sample(1000, attributes=["surface"])
        assert points.faces is not None and points.barycentric is not None
        lie = places(moved, faces, points.faces, points.barycentric)
        self.assertLess(np.abs(lie - points.world_positions()).max(), 2e-5)

    def test_what_is_no_mesh(self) -> None:
        vertices, faces = torus(6, 5)
        bad = vertices.copy()
        bad[7, 1] = np.nan
        beyond = faces.copy()
        beyond[3, 2] = len(vertices)
        cases: list[tuple[type[Exception], str, Any, Any]] = [
            (TypeError, "faces has values of type float64", vertices, faces.astype(float)),
            (TypeError, "vertices has values of type bool", vertices > 0, faces),
            (TypeError, "complex", vertices + 0j, faces),
            (ValueError, r"vertices has shape \(30, 2\), not \(N, 3\)", vertices[:, :2], faces),
            (ValueError, r"faces has shape \(180,\)", vertices, faces.ravel()),
            (curvecast.Error, r"mesh: vertices\[7, 1\] is nan", bad, faces),
            (curvecast.Error, r"faces\[3, 2\] is 30, and there are 30 vertices", vertices, beyond),
            (curvecast.Error, r"faces\[0, 0\] is -1", vertices, faces - 1),
            (curvecast.Error, "no face with an area", vertices, faces[:0]),
            (curvecast.Error, "no face with an area", vertices, np.zeros((4, 3), int)),
        ]
        for kind, message, given, triangles in cases:
            with self.subTest(message), self.assertRaisesRegex(kind, message):
                curvecast.Surface(given, triangles)
        with self.assertRaisesRegex(curvecast.Error, 'scalars."a".* has 3 values for 30 vertices'):
            curvecast.Surface(vertices, faces, scalars={"a": [1, 2, 3]})
        with self.assertRaisesRegex(curvecast.Error, "omega"):
            curvecast.Surface(vertices, faces, omega=1e9)

    def test_what_is_no_view(self) -> None:
        views: list[tuple[str, dict[str, Any]]] = [
            ("points", {"points": 0}),
            ("no attribute 'none'", {"points": 10, "density": density.attribute("none")}),
            ("budget in bytes", {"max_bytes": 10_000}),
            ("camera", {"points": 10, "density": density.screen()}),
            ("relaxation_rounds", {"points": 10, "relaxation_rounds": 101}),
        ]
        for message, options in views:
            with self.subTest(message), self.assertRaisesRegex(curvecast.Error, message):
                self.surface.sample(**options)

    def test_views_are_differences(self) -> None:
        surface = curvecast.Surface(*torus())
        stream = surface.stream()
        held = 0
        for i in range(6):
            camera = Camera((3 * np.cos(0.02 * i), 3 * np.sin(0.02 * i), 1.5), fov=40)
            frame = surface.view(camera, 20_000, density=density.picture())
            whole = stream.frame(View(20_000, camera=camera, density=density.picture()), key_frame=True)
            assert frame.points is not None and whole.points is not None
            self.assertEqual(frame.is_delta, i > 0)
            self.assertEqual(held + frame.added - frame.removed, len(frame.points))
            numpy.testing.assert_array_equal(frame.points.positions, whole.points.positions)
            held = len(frame.points)
            self.assertFalse(frame.points.positions.flags.writeable)
        self.assertGreater(held, 19_000)
        self.assertLess(frame.added, 0.2 * held)

    def test_meshes_and_measures(self) -> None:
        mesh = self.surface.remesh(2000)
        self.assertEqual((len(mesh.vertices), mesh.info.genus, mesh.info.boundary_loops), (2000, 1, 0))
        points = self.surface.sample(4000, sampler="progressive")
        random = np.random.default_rng(1).normal(size=(4000, 3))
        sets: list[Any] = [points, points.world_positions()]
        measures = self.surface.measure(sets)
        self.assertEqual(measures.sets[0].ring_discrepancy, measures.sets[1].ring_discrepancy)
        self.assertGreater(measures.sets[0].spacing.rho, 0.3)
        with self.assertRaises(curvecast.Error):
            self.surface.measure(random * np.inf)

    def test_arrays_are_shared_and_outlive_the_surface(self) -> None:
        points = curvecast.Surface(*torus()).sample(3000)
        gc.collect()
        self.assertTrue(np.shares_memory(np.from_dlpack(points.positions), points.positions))
        points.positions[0] = 7
        self.assertTrue(np.isfinite(points.normals).all() if points.normals is not None else False)

    def test_other_threads_run_meanwhile(self) -> None:
        counted = 0
        done = threading.Event()

        def count() -> None:
            nonlocal counted
            while not done.is_set():
                counted += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        before = counted
        curvecast.Surface(*torus(300, 200), threads=1).sample(200_000)
        done.set()
        thread.join()
        self.assertGreater(counted - before, 20)

    def test_many_threads_at_once(self) -> None:
        surface = curvecast.Surface(*torus())
        found: list[curvecast.Points] = []
        threads = [
            threading.Thread(target=lambda: found.append(surface.sample(9000, density=density.curvature()))) for _ in range(8)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 8)
        for points in found[1:]:
            same(points, found[0])

    def test_progress_is_told_and_may_end_the_work(self) -> None:
        told: list[tuple[str, float]] = []
        curvecast.Surface(*torus(400, 200), on_progress=lambda stage, fraction: told.append((stage, fraction)))
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in told))
        self.assertGreater(len(told), 1)

        def stop(_stage: str, _fraction: float) -> None:
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            curvecast.Surface(*torus(400, 200), on_progress=stop)

    def test_control_c_ends_the_work(self) -> None:
        program = (
            "import signal; from shapes import torus; import curvecast\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # which jobs in the background ignore
            "print('ready', flush=True)\n"
            "try: curvecast.Surface(*torus(3000, 1000), threads=1)\n"
            "except KeyboardInterrupt: print('stopped', flush=True)\n"
        )
        folder = pathlib.Path(__file__).parent
        with subprocess.Popen([sys.executable, "-c", program], cwd=folder, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            self.assertEqual(process.stdout.readline(), "ready\n")
            time.sleep(3)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "stopped\n")
            self.assertEqual(process.wait(60), 0)

    def test_notebooks_show_it(self) -> None:
        surface = curvecast.Surface(*torus(), name="<i>torus</i>")
        shown = surface._repr_html_()
        self.assertIn(curvecast.notebook.picture_html(self.surface.sample(curvecast.notebook.SAMPLE_POINTS)), shown)
        self.assertIn("<caption>&lt;i&gt;torus&lt;/i&gt;</caption>", shown)
        self.assertLess(len(shown), 110_000)
        same(surface.sample(3000), self.surface.sample(3000))

    def test_files_and_what_they_refer_to(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "red.obj")
            path.write_text("mtllib red.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
            plain = curvecast.read(path)
            self.assertIn("red.mtl", "".join(plain.info.warnings))
            path.with_suffix(".mtl").write_text("newmtl red\nKd 1 0 0\n")
            red = curvecast.read(path).sample(100)
            numpy.testing.assert_array_equal(present(red.colours), np.tile([255, 0, 0], (100, 1)))
            path.write_text("v 0 0 0\nf 1 2 3\n")
            with self.assertRaisesRegex(curvecast.Error, "red.obj.*2"):
                curvecast.read(path)
            with self.assertRaises(FileNotFoundError):
                curvecast.read(path.with_name("none.ply"))

    def test_the_readme(self) -> None:
        text = pathlib.Path(__file__).parents[4].joinpath("client/python/README.md").read_text(encoding="utf-8")
        blocks = text.split("\n## With a server\n")[0].split("```python\n")[1:]
        vertices, faces = torus(40, 30)
        with tempfile.TemporaryDirectory() as folder:
            program = "".join(block.split("```")[0] for block in blocks).split("\ndata = ")[0]  # what follows takes PyTorch
            program = program.replace('"scan.npz"', repr(os.path.join(folder, "scan.npz")))
            exec(compile(program, "README.md", "exec"), {"vertices": vertices, "faces": faces})
            self.assertTrue(os.path.exists(os.path.join(folder, "scan.npz")))

    def test_the_example(self) -> None:
        example = pathlib.Path(__file__).parents[4] / "client/python/examples/ten_lines.py"
        with tempfile.TemporaryDirectory() as folder:
            mesh, out = (os.path.join(folder, "torus.off"), os.path.join(folder, "points.npz"))
            write_off(mesh, *torus())
            said = subprocess.run(
                [sys.executable, "-B", example, mesh, out], check=True, capture_output=True, text=True, timeout=900
            )
            *_, even, first, second = said.stdout.splitlines()
            self.assertLess(float(even.split()[1]), 0.3)
            self.assertEqual(first, "view: 50000 points, 50000 came, 0 went")
            came = int(second.split()[3])
            self.assertEqual(second, f"view: 50000 points, {came} came, {came} went")
            self.assertTrue(0 < came < 5000)
            with np.load(out) as arrays:
                self.assertEqual(arrays["positions"].shape, (50_000, 3))
                self.assertEqual(arrays["vertices"].shape, (5000, 3))
                self.assertEqual(len(arrays["triangles"]), 2 * 5000)  # of a torus

    def test_memory_is_given_back(self) -> None:
        vertices, faces = torus(100, 100)

        def resident() -> int:
            return int(pathlib.Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096

        def work() -> None:
            surface = curvecast.Surface(vertices, faces)
            surface.sample(16_000, attributes=["surface"])
            with self.assertRaises(curvecast.Error):
                surface.sample(0)

        for _ in range(5):
            work()
        before = resident()
        for _ in range(15):
            work()
        self.assertLess(resident() - before, 60 << 20)


def read_ply(path: str) -> Any:
    """A PLY file of ours as an array of records."""
    types = {"float": "<f4", "double": "<f8", "uchar": "u1", "uint": "<u4"}
    data = pathlib.Path(path).read_bytes()
    header, _, body = data.partition(b"end_header\n")
    fields = [line.split()[1:] for line in header.decode("ascii").splitlines() if line.startswith("property")]
    return np.frombuffer(body, dtype=[(name, types[kind]) for kind, name in fields])


if __name__ == "__main__":
    unittest.main()
