# SPDX-License-Identifier: Apache-2.0
"""The client: uploads meshes, opens and lists sessions, measures points."""

from __future__ import annotations

import dataclasses
import io
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO

import grpc
import numpy.typing as npt

from curvecast.connection import Connection, OnProgress, told
from curvecast.density import enum_name, vec3
from curvecast.errors import Error, bad_answer
from curvecast.mesh import REFERENCE_ROUNDS, Mesh, as_mesh, find_companion, may_have_companions, mesh_id_of
from curvecast.parameter_mesh import ParameterMesh, decode_parameter_mesh
from curvecast.points import Points, as_points
from curvecast.protocol import MAX_COMPANIONS
from curvecast.sample import decode_sample
from curvecast.session import Session
from curvecast.session_options import session_options
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import Camera, View, as_view


def connect(
    address: str,
    *,
    credentials: grpc.ChannelCredentials | None = None,
    token: str = "",
    short_timeout: float = 30,
    long_timeout: float = 600,
    attempts: int = 5,
    viewer: str = "",
) -> Client:
    """Makes a client of the server at "host:port". The first call opens the connection.

    credentials: for TLS, such as grpc.ssl_channel_credentials(); without them nothing is encrypted. token: by which the server
    knows this client, sent with every call; empty: none. short_timeout: time limit of calls that only look something up, seconds.
    long_timeout: time limit of calls that compute or move data, seconds; preprocessing and measuring have none. attempts: how often
    a call is made in all when the connection or the server is lost (UNAVAILABLE), 0.1 s and more apart. viewer: address of the same
    server's viewer, such as "http://127.0.0.1:8080/", with which notebooks show sessions. ValueError: less than one attempt, or a
    viewer's address that is none or has more than host, port and path.
    """
    return Client(Connection(address, credentials, token, short_timeout, long_timeout, attempts, viewer))


class Client:
    """A connection to a server. Thread-safe. Every call may raise Error. Calls that take `on_progress` call
    `on_progress(stage, fraction)` on the calling thread; an exception from it, such as KeyboardInterrupt, cancels the call and is
    passed on."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection and cancels calls that still run."""
        self._connection.close()

    def upload(self, path: str | os.PathLike[str], on_progress: OnProgress | None = None) -> Mesh:
        """Uploads a mesh file, and the files in its folder that it refers to. Does not send what the server has, and goes on with
        an upload that broke off. Leaves files out that are missing: see inspect(mesh).warnings. OSError: the mesh cannot be
        read."""
        path = pathlib.Path(path)
        mesh = Mesh(self._upload_path(path, on_progress))
        if not may_have_companions(path):
            return mesh
        companions: dict[str, str] = {}
        refused: list[str] = []
        seen: set[str] = set()
        for _ in range(REFERENCE_ROUNDS):
            request = v1.ListMeshReferencesRequest(mesh_id=mesh.id, companions=companions)
            names = self._connection.call("ListMeshReferences", request, self._connection.long_timeout).missing
            before = len(companions)
            for name in names:
                if name in seen or len(seen) >= MAX_COMPANIONS:
                    continue
                seen.add(name)
                try:
                    if (companion := find_companion(path, name)) is not None:
                        companions[name] = self._upload_path(companion, on_progress)
                except (ValueError, OSError) as error:
                    refused.append(str(error))
            if len(companions) == before:
                break
        return dataclasses.replace(mesh, companions=companions, refused=tuple(refused))

    def upload_bytes(self, name: str, data: bytes | memoryview, on_progress: OnProgress | None = None) -> Mesh:
        """Uploads a mesh file from memory, without the files that it refers to. `name`: as of a file; its ending may tell the
        format."""
        return Mesh(self._upload_file(name, io.BytesIO(data), on_progress))

    def import_mesh(self, path: str) -> Mesh:
        """Has the server take a mesh file from the folder that it offers, without the files that the mesh refers to. `path`: in
        that folder, with forward slashes."""
        request = v1.ImportMeshRequest(path=path)
        return Mesh(self._connection.call("ImportMesh", request, self._connection.long_timeout).mesh_id)

    def meshes(self) -> list[v1.StoredMesh]:
        """Lists this caller's files that the server holds, meshes and what they refer to, by mesh_id, with name and size in bytes.
        A server that knows its callers by tokens or certificates tells of those only that this one sent, imported or has asked
        for, and of its own."""
        return [mesh for page in self._pages("ListMeshes", v1.ListMeshesRequest(page_size=1000)) for mesh in page.meshes]

    def inspect(self, mesh: Mesh | str) -> v1.MeshInfo:
        """Tells what a mesh holds, its topology, and what repair does to it."""
        mesh = as_mesh(mesh)
        request = v1.InspectMeshRequest(mesh_id=mesh.id, companions=mesh.companions)
        info: v1.MeshInfo = self._connection.call("InspectMesh", request, self._connection.long_timeout).mesh
        info.warnings.extend(f"{reason}." for reason in mesh.refused)
        return info

    def parameter_mesh(self, mesh: Mesh | str, parameteriser: str = "own", *, chart_faces: int = 0) -> ParameterMesh:
        """Fetches the discs that a mesh is cut into, with their positions in the parameter square. The server computes them anew
        for every call. chart_faces: as of open()."""
        mesh = as_mesh(mesh)
        request = v1.GetParameterMeshRequest(
            mesh_id=mesh.id,
            companions=mesh.companions,
            parameteriser=enum_name(v1.Parameteriser, "PARAMETERISER", parameteriser),
            chart_faces=chart_faces,
        )
        return self._connection.read_stream("GetParameterMesh", request, None, decode_parameter_mesh)

    def scatter(
        self,
        mesh: Mesh | str,
        view: View | int | None = None,
        *,
        crease_degrees: float | None = None,
        on_progress: OnProgress | None = None,
        **options: Any,
    ) -> Points:
        """Samples one point set straight on a mesh, without a session: scatter(mesh, 50_000, relaxation_rounds=2). A tenth of the
        time of open() and sample(), and at least as even.

        view: a number of points, or a View without another budget, ranks or a sequence of its own; options: its fields.
        crease_degrees: as of open().
        """
        mesh = as_mesh(mesh)
        sample = as_view(view, options).to_scattered()
        request = v1.ScatterRequest(mesh_id=mesh.id, companions=mesh.companions, sample=sample, crease_degrees=crease_degrees)

        def take(messages: Iterator[v1.ScatterResponse]) -> Points:
            answers = (message.points for message in told(messages, on_progress) if message.HasField("points"))
            return decode_sample(answers, sample)

        return self._connection.read_stream("Scatter", request, None, take)

    def open(
        self,
        mesh: Mesh | str,
        points: int = 65_536,
        *,
        omega: float = 0,
        density: Sequence[v1.DensityTerm] = (),
        parameteriser: str = "own",
        mapper: str = "exact",
        area: str = "exact",
        seed: int = 0,
        chart_faces: int = 0,
        crease_degrees: float | None = None,
        on_progress: OnProgress | None = None,
    ) -> Session:
        """Prepares a mesh, or joins the session that exists for the same mesh and options, and waits until it is ready.

        points: N for which the curve is made fine enough, up to 4,000,000. omega: curve vertices per point; 0 = 10. density: for
        which the curve is made, without terms of a camera. parameteriser: own or cgal; mapper: exact or id_buffer; area: exact or
        voronoi. seed: of the progressive sampler's points. chart_faces: divides larger components into charts of about so many
        faces; 0 = those of more than 1,000,000, into charts of 100,000. crease_degrees: edges at which faces turn by more are
        sharp, normals do not lean over them; from 0, where all are, to 180, where none are; None = as the file's own
        normals or smoothing groups mean, else 40. An exception in on_progress stops preprocessing on the server too, unless other
        clients wait for the same session.
        """
        mesh = as_mesh(mesh)
        options = session_options(points, omega, density, parameteriser, mapper, area, seed, chart_faces, crease_degrees)
        request = v1.CreateSessionRequest(mesh_id=mesh.id, options=options, companions=mesh.companions, without_preview=True)
        return Session(self._connection, self._connection.call_with_progress("CreateSession", request, "session", on_progress))

    def session(self, session_id: str) -> Session:
        """Finds a session by its id, in the server's memory or its cache."""
        session = Session(self._connection, v1.Session(session_id=session_id))
        session.refresh()
        return session

    def sessions(self) -> list[Session]:
        """Lists the sessions in the server's memory, by id."""
        pages = self._pages("ListSessions", v1.ListSessionsRequest())
        return [Session(self._connection, info) for page in pages for info in page.sessions]

    def measure(
        self,
        mesh: Mesh | str,
        points: Points | npt.ArrayLike | Sequence[Points | npt.ArrayLike] = (),
        *,
        other: Mesh | str | None = None,
        density: Sequence[v1.DensityTerm] = (),
        camera: Camera | Sequence[Camera] = (),
        distance_samples: int = 0,
        ring_seeds: int = 0,
        ball_centres: int = 0,
        seed: int = 0,
        on_progress: OnProgress | None = None,
    ) -> v1.Measures:
        """Measures how evenly points lie on a mesh: discrepancies, spacing, coverage, distance from the surface.

        points: Points or an (N, 3) array of positions in the frame of the mesh file, made by any program; or a list of such sets.
        The measures of set i are in .sets[i]. density: that the points are to have. camera: of terms of a camera, with a square
        picture. ring_seeds, ball_centres: triangles with rings about them, points with balls about them; 0 = 256 and 1,024. seed:
        of their choice. other: another mesh, whose distance (Hausdorff, means, normals) is in .distance, with a camera in its
        pixels too; its means are taken over distance_samples places of each, 0 = 1,000,000.
        """
        mesh = as_mesh(mesh)
        sets = points if isinstance(points, (list, tuple)) else [points]
        cameras = [camera] if isinstance(camera, Camera) else camera
        request = v1.MeasureRequest(
            mesh_id=mesh.id,
            companions=mesh.companions,
            density=density,
            cameras=[c.to_proto() for c in cameras],
            ring_seeds=ring_seeds,
            ball_centres=ball_centres,
            seed=seed,
        )
        if other is not None:
            other = as_mesh(other)
            request.other_mesh_id = other.id
            request.other_companions.update(other.companions)
            request.distance_samples = distance_samples
        for one in map(as_points, sets):
            data = one.positions.astype("<f4", copy=False).tobytes()
            points_id = self.upload_bytes("points", data, on_progress).id
            request.sets.append(v1.UploadedPoints(points_id=points_id, origin=vec3(one.origin)))
        measures: v1.Measures = self._connection.call_with_progress("Measure", request, "measures", on_progress)
        if len(measures.sets) != len(request.sets):
            raise bad_answer(f"asked for the measures of {len(request.sets)} sets, but the server sent {len(measures.sets)}")
        return measures

    def _pages(self, method: str, request: v1.ListMeshesRequest | v1.ListSessionsRequest) -> Iterator[Any]:
        """All answers to a call that lists, each from where the one before has ended."""
        while True:
            page = self._connection.call(method, request, self._connection.short_timeout)
            yield page
            if not page.next_page_token:
                return
            request.page_token = page.next_page_token

    def _upload_path(self, path: pathlib.Path, on_progress: OnProgress | None) -> str:
        with open(path, "rb") as file:
            return self._upload_file(path.name, file, on_progress)

    def _upload_file(self, name: str, file: BinaryIO, on_progress: OnProgress | None) -> str:
        mesh_id = mesh_id_of(file)
        header = v1.UploadHeader(name=name, size=file.seek(0, os.SEEK_END), mesh_id=mesh_id)
        try:
            self._connection.call("GetMesh", v1.GetMeshRequest(mesh_id=mesh_id), self._connection.short_timeout)
        except Error as error:
            if error.code is not grpc.StatusCode.NOT_FOUND:
                raise
            self._connection.upload(header, file, on_progress)
        return mesh_id
