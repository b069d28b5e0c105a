# SPDX-License-Identifier: Apache-2.0
"""A prepared mesh on a server, from which points are taken."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from curvecast import notebook
from curvecast.connection import Connection, OnProgress, told
from curvecast.curve import Curve, decode_curve
from curvecast.neighbours import Neighbours, decode_neighbours
from curvecast.points import Points
from curvecast.protocol import MAX_POINTS
from curvecast.sample import decode_sample
from curvecast.surface_file import SurfaceFile, join_surface
from curvecast.triangle_mesh import TriangleMesh, decode_mesh, remesh_request
from curvecast.v1 import curvecast_pb2 as v1
from curvecast.view import View, as_view
from curvecast.view_stream import HeldFrame, ViewStream

POLL_SECONDS = 0.02  # between questions whether a curve is finer now
MAX_REFINEMENTS = 4  # a density may find the finer curve too coarse again
PREVIEW_TIMEOUT = 10  # seconds, of a call that nobody has asked for


class Session:
    """A prepared mesh on the server, shared by all clients with the same mesh and options. It stays there until close(). `info` is
    how the server described it last."""

    def __init__(self, connection: Connection, info: v1.Session) -> None:
        self._connection = connection
        self.info = info  #: curvecast.v1.Session: options, curve_revision, refining, and a report: mesh, times, distortion

    @property
    def id(self) -> str:
        return self.info.session_id

    def __repr__(self) -> str:
        return f"<curvecast.Session {self.id}>"

    def _repr_html_(self) -> str:
        return notebook.session_html(self.info, self._preview, self._connection.viewer, self._connection.has_token)

    def refresh(self) -> v1.Session:
        """Has the server describe the session anew, and returns `info`."""
        request = v1.GetSessionRequest(session_id=self.id)
        self.info = self._connection.call("GetSession", request, self._connection.short_timeout).session
        return self.info

    def sample(self, view: View | int | None = None, *, patience: float = 0, **options: Any) -> Points:
        """Samples one point set: sample(view), or the fields of a View as arguments: sample(50_000, camera=..., density=[...]).

        Where the curve is too coarse for the view, points.statistics.refining is set and the server makes a finer curve.
        `patience`: seconds that sample() waits for the finer curve, to ask again.
        """
        view = as_view(view, options)
        request = v1.ResampleRequest(session_id=self.id, sample=view.to_proto())
        deadline = time.monotonic() + patience
        points = self._sample_once(request)
        for _ in range(MAX_REFINEMENTS if patience > 0 else 0):
            if not points.statistics.refining:
                break
            while self.refresh().refining:
                if time.monotonic() >= deadline:
                    return points
                time.sleep(POLL_SECONDS)
            points = self._sample_once(request)
        return points

    def stream(self, deltas: bool = True, first_bytes: int = 0, held: HeldFrame | None = None) -> ViewStream:
        """Opens a conversation: views go to the server, frames come back.

        deltas: frames may be differences to the frame before, which the stream applies. first_bytes: with deltas, a frame of more
        bytes than this comes in parts, the first of about this size and with statistics.refining set; 0 = always whole. held:
        held() of a stream of this session that broke off, to go on from its points.
        """
        return ViewStream(self._connection, self.id, deltas, first_bytes, held)

    def remesh(
        self,
        view: View | int | None = None,
        *,
        relaxations: int = 5,
        fit: bool = False,
        feature_degrees: float = 0,
        method: str = "surface",
        **options: Any,
    ) -> TriangleMesh:
        """Makes a triangle mesh of the points of a view, with exactly as many vertices: remesh(10_000, density=[...]). It is
        manifold, with the components, tunnels and borders of the surface.

        relaxations: rounds in which vertices move along the surface, to more regular triangles. fit: vertices leave the surface
        where triangles come nearer to it by that. feature_degrees: edges sharper than this stay edges; 0 = none. method: surface
        or, as the paper has it, parameter: in the square that the surface is mapped to. Error INVALID_ARGUMENT: too few points to
        bear the surface's topology.
        """
        request = remesh_request(as_view(view, options), relaxations, fit, feature_degrees, method)
        request.session_id = self.id
        return self._connection.read_stream("Remesh", request, self._connection.long_timeout, decode_mesh)

    def neighbours(
        self,
        view: View | int | None = None,
        *,
        k: int | None = None,
        radius: float | None = None,
        on_progress: OnProgress | None = None,
        **options: Any,
    ) -> Neighbours:
        """Samples one point set and finds the neighbours of each of its points, straight through space: neighbours(10_000, k=8).

        k: so many that are nearest, 1 to 64. radius: all at most so far away, units; give one of the two. The points come along, as
        sample() would give them. ValueError: both or neither. Error OUT_OF_RANGE: more than 64,000,000 neighbours in all.
        """
        if (k is None) == (radius is None):
            raise ValueError("give one of k and radius")
        view = as_view(view, options)
        request = v1.FindNeighboursRequest(session_id=self.id, sample=view.to_proto(), count=k, radius=radius)
        most = view.points if view.points is not None else MAX_POINTS

        def take(messages: Iterator[v1.FindNeighboursResponse]) -> Neighbours:
            return decode_neighbours(told(messages, on_progress), most, k)

        return self._connection.read_stream("FindNeighbours", request, self._connection.long_timeout, take)

    def curve(self) -> Curve:
        """Fetches the curve itself: all of its vertices, in order."""
        request = v1.GetCurveRequest(session_id=self.id)
        return self._connection.read_stream("GetCurve", request, self._connection.long_timeout, decode_curve)

    def surface(self, position_bits: int = 14) -> SurfaceFile:
        """Fetches the triangles themselves, the repaired mesh, as a file of Draco. position_bits: of each coordinate, of the box's
        longest side, 8 to 24. Errors FAILED_PRECONDITION: the surface has textures, or colours of faces; OUT_OF_RANGE: more than
        a million triangles."""
        request = v1.GetSurfaceRequest(session_id=self.id, position_bits=position_bits)
        return self._connection.read_stream("GetSurface", request, self._connection.long_timeout, join_surface)

    def update(self, pinned: bool | None = None, time_to_live: float | None = None) -> v1.Session:
        """Pins the session in the server's memory, or has it leave that memory after `time_to_live` seconds without use (0 =
        never). None leaves a setting as it is. Returns `info`."""
        request = v1.UpdateSessionRequest(session_id=self.id)
        if pinned is not None:
            request.pinned = pinned
        if time_to_live is not None:
            request.time_to_live = time_to_live
        self.info = self._connection.call("UpdateSession", request, self._connection.short_timeout).session
        return self.info

    def close(self) -> None:
        """Has the server forget the session, in memory and in its cache, for all clients."""
        self._connection.call_once("CloseSession", v1.CloseSessionRequest(session_id=self.id), self._connection.short_timeout)

    def _preview(self, points: int) -> Points:
        request = v1.ResampleRequest(session_id=self.id, sample=View(points).to_proto())
        return self._sample_once(request, PREVIEW_TIMEOUT)

    def _sample_once(self, request: v1.ResampleRequest, timeout: float | None = None) -> Points:
        return self._connection.read_stream(
            "Resample", request, timeout or self._connection.long_timeout, lambda messages: decode_sample(messages, request.sample)
        )
