"""A real server on a free port of the loopback, which ends with its tests, and shapes to bring to it."""

import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
from collections.abc import Callable
from typing import IO, Any, ClassVar, TypeVar, cast

import numpy as np

import curvecast

T = TypeVar("T")

#: Whether the build made the Draco decoder, as the build says. What the package says of itself is what the tests check.
WITH_DRACO = os.environ["CURVECAST_DRACO"] == "1"


class Server:
    """The command under test, serving. The kernel ends it should this process die without stop()."""

    def __init__(self, *options: str) -> None:
        command = ["setpriv", "--pdeathsig", "TERM", os.environ["CURVECAST_COMMAND"]]
        command += ["serve", "--listen", "127.0.0.1:0", "--quiet", *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.output = cast(IO[str], self.process.stdout)
        line = self.output.readline()
        if not line.startswith("listening on "):
            raise RuntimeError(f"the server did not start: {line!r}")
        self.address = line.split()[-1]

    def stop(self) -> None:
        self.process.terminate()
        self.output.close()
        if (status := self.process.wait()) != 0:
            raise RuntimeError(f"the server ended with status {status}")


class ServerTest(unittest.TestCase):
    """One server, a client of it and a folder for all tests of a class."""

    folder: ClassVar[pathlib.Path]
    server: ClassVar[Server]
    client: ClassVar[curvecast.Client]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="curvecast-python-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)
        cls.client = curvecast.connect(cls.server.address)
        cls.addClassCleanup(cls.client.close)

    def assert_refused(
        self, code: str, message: str, call: Callable[..., object], *arguments: Any, **options: Any
    ) -> curvecast.Error:
        with self.assertRaises(curvecast.Error) as caught:
            call(*arguments, **options)
        self.assertEqual(caught.exception.code.name, code, caught.exception)
        self.assertIn(message, caught.exception.message)
        return caught.exception

    def assert_same_points(self, one: curvecast.Points, other: curvecast.Points) -> None:
        """Every column, exactly; radii to a few units of the last place."""
        for name in ("origin", "positions", "normals", "colours", "curvatures", "ranks", "faces", "barycentric", "directions"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name), name)
        np.testing.assert_equal(one.scalars, other.scalars)
        np.testing.assert_allclose(present(one.radii), present(other.radii), rtol=1e-5)


def present(value: T | None) -> T:
    """What has to be there."""
    assert value is not None
    return value


def sphere_obj(rings: int = 24, radius: float = 1, centre: tuple[float, float, float] = (0, 0, 0), header: str = "") -> str:
    """A sphere of `rings` x 2 `rings` quads with its poles, in the words of an OBJ file."""
    columns = 2 * rings
    lines = [header] if header else []
    for ring in range(rings + 1):
        theta = math.pi * ring / rings
        for column in range(columns if 0 < ring < rings else 1):
            phi = 2 * math.pi * column / columns
            x, y, z = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
            lines.append("v " + " ".join(repr(c + radius * v) for c, v in zip(centre, (x, y, z), strict=True)))

    def index(ring: int, column: int) -> int:
        return 1 if ring == 0 else 2 + (rings - 1) * columns if ring == rings else 2 + (ring - 1) * columns + column % columns

    for ring in range(rings):
        for column in range(columns):
            corners = [index(ring, column), index(ring, column + 1), index(ring + 1, column + 1), index(ring + 1, column)]
            lines.append("f " + " ".join(map(str, dict.fromkeys(corners))))
    return "\n".join(lines) + "\n"


def tube_ply(rings: int = 20, sectors: int = 60) -> str:
    """An open tube of radius 1 around the z axis, as a PLY file. Its vertices are as hot as 2 x - y + z, and of unknown age."""
    header = f"ply\nformat ascii 1.0\nelement vertex {(rings + 1) * sectors}\n"
    properties = ["x", "y", "z", "heat", "age"]
    lines = [header + "".join(f"property float {name}\n" for name in properties) + f"element face {rings * sectors}"]
    lines += ["property list uchar int vertex_indices", "end_header"]
    for ring in range(rings + 1):
        for sector in range(sectors):
            x, y = math.cos(2 * math.pi * sector / sectors), math.sin(2 * math.pi * sector / sectors)
            z = 2 * ring / rings
            lines.append(f"{x} {y} {z} {2 * x - y + z} nan")
    for ring in range(rings):
        for sector in range(sectors):
            a, b = ring * sectors + sector, ring * sectors + (sector + 1) % sectors
            lines.append(f"4 {a} {b} {b + sectors} {a + sectors}")
    return "\n".join(lines) + "\n"


def eye_at(degrees: float, distance: float, height: float = 0.3) -> tuple[float, float, float]:
    """On a circle about the y axis."""
    angle = math.radians(degrees)
    return (distance * math.sin(angle), height, distance * math.cos(angle))
