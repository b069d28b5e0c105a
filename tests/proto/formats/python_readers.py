"""NumPy, laspy and plyfile read files of points; deploy/check_formats installs them, and prints what they were compared in."""

from __future__ import annotations

import contextlib
import importlib.metadata
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from collections.abc import Iterator
from typing import Any

import laspy  # type: ignore[import-not-found]
import numpy as np
import plyfile  # type: ignore[import-not-found]

COMMAND = os.environ.get("CURVECAST_COMMAND", "build/release/curvecast")
COUNT = 4000
FAR = np.array([500_000.25, -4_600_000.5, 12.125])
NPZ = {  # the names that .ply has for the columns of .npz
    "positions": "x y z",
    "normals": "nx ny nz",
    "radii": "radius",
    "colours": "red green blue",
    "ranks": "rank",
    "curvatures": "curvature_min curvature_max",
    "directions": "direction_min_x direction_min_y direction_min_z",
    "scalar heat": "scalar_heat",
    "faces": "face",
    "barycentric": "barycentric_2 barycentric_3",
}


def write_mesh(path: pathlib.Path, far: np.ndarray[Any, Any]) -> None:
    """A hill with colours and a named value of each vertex."""
    side = 60
    across, along = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side)))
    places = np.stack([across, along, 0.4 * np.exp(-3 * (across**2 + along**2))], axis=1) + far
    rows = [("x", "f8"), ("y", "f8"), ("z", "f8"), ("red", "u1"), ("green", "u1"), ("blue", "u1"), ("heat", "f4")]
    vertices = np.empty(side * side, dtype=rows)
    for axis, name in enumerate("xyz"):
        vertices[name] = places[:, axis]
    vertices["red"], vertices["green"], vertices["blue"] = 128 + 100 * across, 128 + 100 * along, 77
    vertices["heat"] = across + 3 * along
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.empty(len(first), dtype=[("vertex_indices", "i4", (4,))])
    faces["vertex_indices"] = np.stack([first, first + 1, first + side + 1, first + side], axis=1)
    elements = [plyfile.PlyElement.describe(vertices, "vertex"), plyfile.PlyElement.describe(faces, "face")]
    plyfile.PlyData(elements).write(path)


@contextlib.contextmanager
def compared(form: str, program: str, what: str, result: str) -> Iterator[None]:
    """Adds a comparison to the table of reader_table.mjs: with `result` where nothing was found wrong, else as failed."""
    row = [form, f"{program} {importlib.metadata.version(program.lower())}", what]
    try:
        yield
    except BaseException:
        result = "FAILED"
        raise
    finally:
        if table := os.environ.get("CURVECAST_READER_TABLE"):
            with open(table, "a", encoding="utf-8") as file:
                file.write("\t".join([*row, result]) + "\n")


class ReadersTest(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def sample(self, mesh: pathlib.Path, name: str, *words: str, sampler: str = "progressive") -> pathlib.Path:
        output = self.folder / name
        command = [COMMAND, "sample", str(mesh), "-n", str(COUNT), "--sampler", sampler, "--quiet", *words, "-o", str(output)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=os.environ | {"XDG_CACHE_HOME": str(self.folder)})
        return output

    def meshes(self) -> list[tuple[pathlib.Path, Any]]:
        found = []
        for name, far in (("near.ply", np.zeros(3)), ("far.ply", FAR)):
            write_mesh(self.folder / name, far)
            every = ["--attributes", "rank,curvatures,directions,scalars,surface"]
            vertices = plyfile.PlyData.read(self.sample(self.folder / name, "reference_" + name, *every))["vertex"].data
            found.append((self.folder / name, vertices[np.argsort(vertices["rank"], kind="stable")]))
        return found

    def test_numpy_reads_npy_and_npz(self) -> None:
        for mesh, points in self.meshes():
            wanted = np.stack([points[axis] for axis in "xyz"], axis=1)
            with compared(".npy", "NumPy", "places", f"{mesh.stem}: equal"):
                alone = np.load(self.sample(mesh, "points.npy"))
                self.assertEqual(alone.dtype, wanted.dtype)
                np.testing.assert_array_equal(alone, wanted)
            path = self.sample(mesh, "points.npz", "--attributes", "rank,curvatures,directions,scalars,surface")
            with compared(".npz", "NumPy", "all ten columns", f"{mesh.stem}: equal"), np.load(path) as arrays:
                for name, of_ply in NPZ.items():
                    columns = np.stack([points[each] for each in of_ply.split()], axis=-1)
                    np.testing.assert_array_equal(arrays[name], columns.reshape(arrays[name].shape), err_msg=name)
                self.assertEqual(set(arrays.files), set(NPZ))

    def test_laspy_reads_las(self) -> None:
        for mesh, points in self.meshes():
            path = self.sample(mesh, "points.las", "--attributes", "rank,curvatures,scalars,surface")
            with compared(".las", "laspy", "version, places, box, colours, extra columns", f"{mesh.stem}: within 1e-8"):
                self.compare_las(path, points)

    def compare_las(self, path: pathlib.Path, points: Any) -> None:
        cloud = laspy.read(path)
        self.assertEqual((str(cloud.header.version), cloud.header.point_format.id, len(cloud.points)), ("1.4", 7, COUNT))
        wanted = np.stack([points[axis] for axis in "xyz"], axis=1).astype(float)
        self.assertLess(np.abs(cloud.xyz - wanted).max(), 1e-8)
        np.testing.assert_allclose(cloud.header.mins, cloud.xyz.min(axis=0), rtol=0, atol=1e-9)
        np.testing.assert_allclose(cloud.header.maxs, cloud.xyz.max(axis=0), rtol=0, atol=1e-9)
        np.testing.assert_array_equal(np.asarray(cloud.green), points["green"].astype(np.uint16) * 257)
        pairs = {"radius": "radius", "NormalX": "nx", "NormalZ": "nz", "rank": "rank", "face": "face", "heat": "scalar_heat"}
        pairs |= {"curvature_max": "curvature_max", "barycentric_2": "barycentric_2"}
        for name, own in pairs.items():
            np.testing.assert_array_equal(np.asarray(cloud[name]), points[own], err_msg=name)

    def test_plyfile_reads_splats(self) -> None:
        for mesh, points in self.meshes():
            path = self.sample(mesh, "splats.ply", "--splats")
            with compared(".ply of splats", "plyfile", "places, widths, colours", f"{mesh.stem}: places equal"):
                self.compare_splats(plyfile.PlyData.read(path), points, is_far=mesh.stem == "far")

    def compare_splats(self, data: Any, points: Any, is_far: bool) -> None:
        splats = data["vertex"].data
        origin = np.array([float(number) for number in data.comments[0].split()[1:]]) if data.comments else np.zeros(3)
        self.assertEqual(bool(data.comments), is_far)
        for axis, name in enumerate("xyz"):
            np.testing.assert_array_equal(
                splats[name].astype(points[name].dtype) + origin[axis].astype(points[name].dtype), points[name]
            )
        np.testing.assert_allclose(np.exp(splats["scale_0"]), 0.75 * points["radius"], rtol=1e-5)
        np.testing.assert_allclose(0.5 + 0.28209479 * splats["f_dc_0"], points["red"] / 255, atol=1e-6)

    def test_points_along_the_curve(self) -> None:
        mesh = self.folder / "near.ply"
        write_mesh(mesh, np.zeros(3))
        points = plyfile.PlyData.read(self.sample(mesh, "own.ply", sampler="equalised"))["vertex"].data
        wanted = np.stack([points[name] for name in ("x", "y", "z", "nx", "ny", "nz")], axis=1)
        # Points without ranks stand so in .npy, too.
        np.testing.assert_array_equal(np.load(self.sample(mesh, "own.npy", sampler="equalised"))[:, 0], points["x"])
        path = self.sample(mesh, "own.xyz", sampler="equalised")
        with compared(".xyz", "NumPy", "places, normals", "equal"):
            np.testing.assert_array_equal(np.loadtxt(path, dtype=np.float32, usecols=range(6)), wanted)
        # Against the mesh itself, which the test has made: z of the hill, its colours, its values.
        with compared(".ply", "plyfile", "places on the mesh, colours, radii", "on the mesh within its chords"):
            flat = points["x"].astype(float) ** 2 + points["y"].astype(float) ** 2
            self.assertLess(np.abs(points["z"] - 0.4 * np.exp(-3 * flat)).max(), 1e-3)
            self.assertLess(np.abs(points["red"] - (128 + 100 * points["x"].astype(float))).max(), 1.51)  # rounded twice
            self.assertTrue((points["radius"] > 0).all())


if __name__ == "__main__":
    if not pathlib.Path(COMMAND).exists():
        sys.exit(f"there is no {COMMAND}; deploy/build builds it")
    unittest.main(verbosity=2)
