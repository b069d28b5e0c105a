# SPDX-License-Identifier: Apache-2.0
"""Surfaces in this process, without a server. They need the module _native, which `deploy/wheel` builds."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.util
import os
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast import notebook
from curvecast.connection import OnProgress
from curvecast.errors import error_of
from curvecast.frame import Frame, decode_frame
from curvecast.mesh import REFERENCE_ROUNDS, find_companion, may_have_companions
from curvecast.points import Points, as_points, decode_blocks, points_of
from curvecast.protocol import MAX_POINTS
from curvecast.session_options import session_options
from curvecast.triangle_mesh import TriangleMesh, decode_mesh, remesh_request
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import Camera, View, as_view

MOST_THREADS = 1024  # far more than there are cores
#: Whether this copy can sample meshes without a server.
HAS_LOCAL = importlib.util.find_spec("curvecast._native") is not None
if HAS_LOCAL:  # a module that is there and does not load is an error
    from curvecast import _native


class Surface:
    """A mesh, cut to charts, of which any number of point sets can be taken. Thread-safe: other threads of Python run meanwhile.
    The same mesh, options and seed give the same points, as the command gives them, whatever was asked before. View.seed is that of
    both samplers."""

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        *,
        colours: npt.ArrayLike | None = None,
        scalars: Mapping[str, npt.ArrayLike] | None = None,
        name: str = "mesh",
        points: int = 0,
        omega: float = 0,
        density: Sequence[v1.DensityTerm] = (),
        chart_faces: int = 0,
        crease_degrees: float | None = None,
        prepare: bool = True,
        threads: int = 0,
        on_progress: OnProgress | None = None,
    ) -> None:
        """Repairs the mesh, cuts it and flattens it: what all samples of it share.

        vertices: (V, 3) numbers. faces: (F, 3) integers. They are copied; what points say of faces is true of these, also where
        repair turned or dropped some. colours: (V, 3), 0 to 255. scalars: (V,) numbers under names, for density.attribute() and the
        attribute scalars. name: of messages. points: N for which the curve is made fine enough; 0 = 4,096, 16,384, 65,536 or as
        many as a sample asks for. omega, density, chart_faces, crease_degrees: as of Client.open(). prepare: cut and flatten it
        now; else once that is needed, which scatter(), training_set() and signed_distance() do not. threads: up to 1,024; 0 = one a
        core. on_progress(stage, fraction) is called on this thread; an exception from it, and Ctrl-C, end the work. TypeError,
        ValueError: arrays of another shape or kind, names that are no text. Error INVALID_ARGUMENT: no mesh; says which vertex or
        face is at fault. ImportError: this copy has no _native."""
        _check_native()
        mesh = _mesh_arrays(vertices, faces, colours, scalars, name)
        _check_range("threads", threads, MOST_THREADS)
        options = session_options(points, omega, density, "own", "exact", "exact", 0, chart_faces, crease_degrees)
        with _translate_errors():
            self._native = _native.Surface.make(*mesh, options.SerializeToString(), prepare, threads, on_progress)
        self._set_up(threads)

    def _set_up(self, threads: int) -> None:
        self._threads = threads
        self._stream = SurfaceStream(self)
        #: curvecast.v1.MeshInfo: what the mesh holds, its topology, and what repair did
        self.info = v1.MeshInfo.FromString(self._native.info())

    def __repr__(self) -> str:
        return f"<curvecast.Surface {self.info.name}, {self.info.faces} faces>"

    def _repr_html_(self) -> str:
        return notebook.surface_html(self.info, self.sample)

    def sample(self, view: View | int | None = None, **options: Any) -> Points:
        """Samples one point set: sample(view), or the fields of a View as arguments: sample(50_000, density=[...], seed=1). Where
        the curve is too coarse for the view it is made finer first. Errors as the server has them."""
        request = as_view(view, options).to_proto()
        with _translate_errors():
            columns = self._native.sample(request.SerializeToString(), self._threads)
        statistics = v1.FrameStatistics.FromString(columns.pop("statistics"))
        return dataclasses.replace(points_of(columns.pop("origin"), columns), statistics=statistics)

    def scatter(self, view: View | int | None = None, *, on_progress: OnProgress | None = None, **options: Any) -> Points:
        """Places points straight on the mesh: as curvecast.scatter() of its vertices and faces, whose points these are. With the
        attribute "rank" points have an order of which every prefix is even: see nested()."""
        request = as_view(view, options).to_scattered()
        with _translate_errors():
            columns = self._native.scatter(request.SerializeToString(), self._threads, on_progress)
        return points_of(columns.pop("origin"), columns)

    def view(self, camera: Camera | View, points: int | None = None, **options: Any) -> Frame:
        """Samples for a camera, as a difference to the view before: view(camera, 50_000, density=[density.picture()]). All points
        are in .points, which are read-only; .added and .removed say how many came and went."""
        view = camera if isinstance(camera, View) else View(points=points, camera=camera)
        return self._stream.frame(dataclasses.replace(view, **options))

    def stream(self) -> SurfaceStream:
        """Begins views of their own, beside those of view()."""
        return SurfaceStream(self)

    def remesh(
        self,
        view: View | int | None = None,
        *,
        relaxations: int = 5,
        fit: bool = False,
        feature_degrees: float = 0,
        method: str = "surface",
        on_progress: OnProgress | None = None,
        **options: Any,
    ) -> TriangleMesh:
        """Makes a triangle mesh of the points of a view, with exactly as many vertices: as Session.remesh()."""
        request = remesh_request(as_view(view, options), relaxations, fit, feature_degrees, method)
        with _translate_errors():
            answers = self._native.remesh(request.SerializeToString(), self._threads, on_progress)
        return decode_mesh(map(v1.RemeshResponse.FromString, answers))

    def measure(
        self,
        points: Points | npt.ArrayLike | Sequence[Points | npt.ArrayLike],
        *,
        density: Sequence[v1.DensityTerm] = (),
        camera: Camera | Sequence[Camera] = (),
        ring_seeds: int = 0,
        ball_centres: int = 0,
        seed: int = 0,
        on_progress: OnProgress | None = None,
    ) -> v1.Measures:
        """Measures how evenly points lie on the mesh: as Client.measure()."""
        sets = points if isinstance(points, (list, tuple)) else [points]
        cameras = [camera] if isinstance(camera, Camera) else camera
        request = v1.MeasureRequest(
            density=density, cameras=[c.to_proto() for c in cameras], ring_seeds=ring_seeds, ball_centres=ball_centres, seed=seed
        )
        places = [one.world_positions() for one in map(as_points, sets)]
        with _translate_errors():
            return v1.Measures.FromString(self._native.measure(request.SerializeToString(), places, self._threads, on_progress))

    def features(self, points: int, degrees: float = 30, seed: int = 0) -> FeaturePoints:
        """Places points evenly on the sharp edges: those at which faces turn by more than `degrees`. None where there are no such
        edges. ValueError: more than 4,000,000 points, or an angle that is not from 0 to 180."""
        _check_range("points", points, MAX_POINTS)
        _check_range("degrees", degrees, 180)
        with _translate_errors():
            found = self._native.features(degrees, points, seed, self._threads)
        sides = found["normals"].reshape(-1, 2, 3)
        middle = sides.sum(axis=1)
        middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), np.finfo(np.float32).tiny)
        placed = dataclasses.replace(
            as_points(found["positions"]), normals=middle, faces=found["faces"], barycentric=found["barycentric"]
        )
        return FeaturePoints(placed, sides, found["length"])

    def signed_distance(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Finds how far (N, 3) places are from the surface, below 0 inside. Error FAILED_PRECONDITION: the mesh has borders, and so
        no inside."""
        places = _array(points, "points", np.float64, np.number, (None, 3))
        if not np.isfinite(places).all():
            raise ValueError("points has coordinates that are not finite")
        with _translate_errors():
            return self._native.distances(places, self._threads)

    def mesh(self) -> RepairedMesh:
        """Returns a copy of the mesh as repair made it of what was given."""
        return RepairedMesh(**self._native.mesh())


@dataclasses.dataclass(frozen=True, eq=False)
class FeaturePoints:
    """Points on sharp edges."""

    points: Points  #: with normals between those of both sides, and their places on the faces given
    side_normals: npt.NDArray[np.float32]  #: (N, 2, 3), unit vectors: of the faces on both sides
    length: float  #: of all sharp edges, units


@dataclasses.dataclass(frozen=True, eq=False)
class RepairedMesh:
    """A manifold, oriented triangle mesh."""

    vertices: npt.NDArray[np.float64]  #: (V, 3), units
    triangles: npt.NDArray[np.uint32]  #: (T, 3): vertices, counter-clockwise seen from outside
    faces: npt.NDArray[np.uint32]  #: (T,): the faces given that these are, or are parts of
    turned: npt.NDArray[np.bool_]  #: (T,): whether second and third corner are in the other order there


class SurfaceStream:
    """Views of a surface, one after the other; each is a difference to the one before. For one thread at a time."""

    def __init__(self, surface: Surface) -> None:
        self._native = _native.Stream(surface._native)
        self._threads = surface._threads
        self._points = decode_blocks([])
        self._sequence = 0

    def frame(self, view: View, key_frame: bool = False) -> Frame:
        """Samples a view. `key_frame`: without the points of the view before. The bytes are those that a server would send."""
        request = view.to_proto(in_stream=True).SerializeToString()
        self._sequence += 1
        with _translate_errors():
            message = v1.PointFrame.FromString(self._native.frame(request, key_frame, self._threads))
        message.sequence = self._sequence
        frame = decode_frame(message, self._points)
        assert frame.points is not None
        self._points = frame.points
        return frame


def read(
    path: str | os.PathLike[str],
    *,
    points: int = 0,
    omega: float = 0,
    density: Sequence[v1.DensityTerm] = (),
    parameteriser: str = "own",
    mapper: str = "exact",
    area: str = "exact",
    chart_faces: int = 0,
    crease_degrees: float | None = None,
    prepare: bool = True,
    threads: int = 0,
    on_progress: OnProgress | None = None,
) -> Surface:
    """Reads a mesh file, and the files in its folder that it refers to; arguments as of Surface and of Client.open(). Files that
    are missing are left out: see .info.warnings. OSError: the mesh cannot be read. Error INVALID_ARGUMENT: it is none."""
    _check_native()
    _check_range("threads", threads, MOST_THREADS)
    file = _read_files(path)
    options = session_options(points, omega, density, parameteriser, mapper, area, 0, chart_faces, crease_degrees)
    surface = Surface.__new__(Surface)
    with _translate_errors():
        surface._native = _native.Surface.read(
            file.name, file.data, file.companions, options.SerializeToString(), prepare, threads, on_progress
        )
    surface._set_up(threads)
    surface.info.warnings.extend(file.refused.values())
    return surface


def scatter(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    view: View | int | None = None,
    *,
    colours: npt.ArrayLike | None = None,
    scalars: Mapping[str, npt.ArrayLike] | None = None,
    name: str = "mesh",
    crease_degrees: float | None = None,
    threads: int = 0,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> Points:
    """Places points straight on a mesh, without a Surface: scatter(vertices, faces, 16_384, relaxation_rounds=2, seed=1). For one
    set of points: nothing is cut or flattened, which takes most of a Surface's time, and the points are at least as even.

    vertices, faces, colours, scalars, name, crease_degrees, threads, on_progress: as of Surface. view: a number of points, or a
    View without another budget, ranks or a sequence of its own; options: its fields. Points have faces and barycentric in any case,
    and stand along a curve over the faces as they follow one another in space. The same mesh, options and seed give the same
    points; a seed moves all of them along the curve. Errors as of Surface and its sample()."""
    _check_native()
    mesh = _mesh_arrays(vertices, faces, colours, scalars, name)
    _check_range("threads", threads, MOST_THREADS)
    request = as_view(view, options).to_scattered().SerializeToString()
    with _translate_errors():
        columns = _native.scatter(*mesh, request, crease_degrees, threads, on_progress)
    return points_of(columns.pop("origin"), columns)


def scatter_file(
    path: str | os.PathLike[str],
    view: View | int | None = None,
    *,
    crease_degrees: float | None = None,
    threads: int = 0,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> Points:
    """Places points straight on a mesh file, with the colours and textures that it has: scatter_file("mesh.glb", 16_384). As
    scatter(); files that the mesh refers to are found as by read(). Points are those of the command with --sampler scattered."""
    _check_native()
    _check_range("threads", threads, MOST_THREADS)
    file = _read_files(path)
    request = as_view(view, options).to_scattered().SerializeToString()
    with _translate_errors():
        columns = _native.scatter_file(file.name, file.data, file.companions, request, crease_degrees, threads, on_progress)
    return points_of(columns.pop("origin"), columns)


@dataclasses.dataclass(frozen=True)
class _File:
    """A mesh file, and those in its folder that it refers to."""

    name: str
    data: bytes
    companions: dict[str, bytes]
    refused: dict[str, str]  # why others, by their names, were not taken


def _read_files(path: str | os.PathLike[str]) -> _File:
    """OSError: the mesh cannot be read. Error INVALID_ARGUMENT: it is none."""
    path = pathlib.Path(path)
    name = os.fsencode(path.name).decode("utf-8", "replace")  # a name need not be UTF-8, the messages are
    file = _File(name, path.read_bytes(), {}, {})
    for _ in range(REFERENCE_ROUNDS if may_have_companions(path) else 0):
        before = len(file.companions)
        with _translate_errors():
            names = _native.references(file.name, file.data, file.companions)
        for other in names:
            try:
                if (companion := find_companion(path, other)) is not None:
                    file.companions[other] = companion.read_bytes()
            except (ValueError, OSError) as error:
                file.refused[other] = f"{error}."
        if len(file.companions) == before:
            break
    return file


def _mesh_arrays(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    colours: npt.ArrayLike | None,
    scalars: Mapping[str, npt.ArrayLike] | None,
    name: str,
) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any] | None, dict[str, npt.NDArray[Any]], str]:
    """Makes of a mesh what _native takes. TypeError, ValueError: arrays of another shape or kind, names that are no text."""
    return (
        _array(vertices, "vertices", np.float64, np.number, (None, 3)),
        _array(faces, "faces", np.int64, np.integer, (None, 3)),
        None if colours is None else _array(colours, "colours", np.uint8, np.uint8, (None, 3)),
        {
            _text(key, "a name in scalars"): _array(value, f"scalars[{key!r}]", np.float32, np.number, (None,))
            for key, value in (scalars or {}).items()
        },
        _text(name, "name"),
    )


def _check_native() -> None:
    if not HAS_LOCAL:
        raise ImportError("this copy of curvecast knows servers only: surfaces in this process take the wheel of deploy/wheel")


def _check_range(name: str, value: float, most: float) -> None:
    """ValueError: the value is not from 0 to `most`."""
    if not 0 <= value <= most:
        raise ValueError(f"{name} is {value}; it has to be from 0 to {most}")


def _text(value: str, name: str) -> str:
    """Checks what is to be text. TypeError: something else; ValueError: text that UTF-8 does not have."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}, which is no text")
    value.encode()
    return value


def _array(values: npt.ArrayLike, name: str, kind: type, accepted: type, shape: tuple[int | None, ...]) -> npt.NDArray[Any]:
    """Makes a contiguous array of `kind`. TypeError: numbers of another sort; ValueError: another shape."""
    array = np.asarray(values)
    if array.size and not np.issubdtype(array.dtype, accepted):
        raise TypeError(f"{name} has values of type {array.dtype}")
    if np.issubdtype(array.dtype, np.complexfloating):
        raise TypeError(f"{name} has complex values")
    if array.ndim != len(shape) or any(wanted not in (None, size) for wanted, size in zip(shape, array.shape, strict=True)):
        wanted_shape = ", ".join("N" if size is None else str(size) for size in shape)
        raise ValueError(f"{name} has shape {array.shape}, not ({wanted_shape}{',' if len(shape) == 1 else ''})")
    return np.ascontiguousarray(array, dtype=kind)


@contextlib.contextmanager
def _translate_errors() -> Iterator[None]:
    try:
        yield
    except _native.Error as error:
        raise error_of(*error.args) from None
