# SPDX-License-Identifier: Apache-2.0
"""What determines a point set: how many points, with which density, seen from where."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import grpc

from curvecast.density import Vector, enum_name, vec3
from curvecast.errors import Error
from curvecast.points import HAS_DRACO
from curvecast.v1 import curvecast_pb2 as v1

_OTHER_NAMES = {"niederreiter": "van_der_corput"}  # in one dimension and base 2 both are one sequence


@dataclasses.dataclass(frozen=True)
class Camera:
    """A perspective camera, or an orthographic one where `orthographic_height` is above 0."""

    eye: Vector  #: x, y, z
    target: Vector = (0, 0, 0)
    up: Vector = (0, 1, 0)
    fov: float = 45  #: vertical, degrees, between 0 and 180
    orthographic_height: float = 0  #: of its picture, units

    def to_proto(self) -> v1.Camera:
        return v1.Camera(
            eye=vec3(self.eye),
            target=vec3(self.target),
            up=vec3(self.up),
            vertical_fov_degrees=self.fov,
            orthographic_height=self.orthographic_height,
        )


@dataclasses.dataclass(frozen=True)
class View:
    """A view of a session. Give one budget: `points`, `pixel_error`, `max_bytes` or, in a stream, `frame_seconds`."""

    points: int | None = None  #: N, 1 to 4,000,000
    pixel_error: float | None = None  #: pixels: the fewest points of which none stands for more than a square of this side
    max_bytes: int | None = None  #: as many points as this number of bytes holds
    frame_seconds: float | None = None  #: seconds: as many points as a stream can send and a client decode in this time; 0 = 0.1
    density: Sequence[v1.DensityTerm] | v1.DensityTerm = ()  #: of curvecast.density, multiplied
    camera: Camera | Sequence[Camera] = ()  #: with several there are points for all of them
    viewport: tuple[int, int] | None = None  #: width and height in pixels; default 1024 x 1024
    #: equalised, or progressive: fixed positions and ranks, more even, small deltas. None: progressive in a stream and where ranks
    #: are asked for, unless `sequence` is another than jittered; else equalised
    sampler: str | None = None
    sequence: str = "jittered"  #: or regular, van_der_corput (also: niederreiter), golden_ratio; of the equalised sampler
    seed: int = 0  #: of the equalised sampler; that of the progressive one is the session's
    #: 0 to 100, of the equalised sampler: in so many rounds points move along the surface, away from their neighbours, to blue
    #: noise as even at large as before: 3 will do, 10 leave fewer holes. Not in a stream
    relaxation_rounds: int = 0
    #: of curvatures, directions, scalars (the mesh's named values), rank (not of equalised points), surface (faces, barycentric)
    attributes: Sequence[str] = ()
    encoding: str = "raw"  #: exactly as computed; or draco: a tenth of the bytes, rounded
    position_bits: int = 0  #: of draco, per coordinate over the largest side of the mesh's box; 0 = as the camera's pixels ask for
    normal_bits: int = 0  #: of draco; 0 = 8

    def to_proto(self, in_stream: bool = False) -> v1.SampleRequest:
        """Makes the message of the API, for one answer or for a stream. ValueError: not exactly one budget, or a name that the API
        does not know."""
        automatic = None if self.frame_seconds is None else v1.AutomaticBudget(frame_seconds=self.frame_seconds)
        budgets = {"points": self.points, "pixel_error": self.pixel_error, "max_bytes": self.max_bytes, "automatic": automatic}
        given: dict[str, Any] = {name: value for name, value in budgets.items() if value is not None}
        if len(given) != 1:
            raise ValueError(f"a view takes one of points, pixel_error, max_bytes and frame_seconds, not {len(given)}")
        terms = [self.density] if isinstance(self.density, v1.DensityTerm) else self.density
        cameras = [self.camera] if isinstance(self.camera, Camera) else self.camera
        request = v1.SampleRequest(
            **given,
            density=terms,
            cameras=[camera.to_proto() for camera in cameras],
            seed=self.seed,
            relaxation_rounds=self.relaxation_rounds,
            encoding=self._encoding(),
            sequence=enum_name(v1.Sequence, "SEQUENCE", _OTHER_NAMES.get(self.sequence, self.sequence)),
            sampler=enum_name(v1.Sampler, "SAMPLER", self._sampler(in_stream)),
            attributes=[enum_name(v1.PointAttribute, "POINT_ATTRIBUTE", name) for name in self.attributes],
        )
        if self.viewport is not None:
            request.viewport.width, request.viewport.height = self.viewport
        return request

    def to_scattered(self) -> v1.SampleRequest:
        """The message for points straight on a mesh, which may have ranks all the same."""
        return dataclasses.replace(self, sampler=self.sampler or "equalised").to_proto()

    def _sampler(self, in_stream: bool) -> str:
        if self.sampler is not None:
            return self.sampler
        is_progressive = "rank" in self.attributes or (in_stream and self.sequence == "jittered")
        return "progressive" if is_progressive else "equalised"

    def _encoding(self) -> v1.Encoding:
        if self.encoding == "raw":
            return v1.Encoding(raw=v1.RawEncoding())
        if self.encoding != "draco":
            raise ValueError(f"encoding is raw or draco, not {self.encoding!r}")
        if not HAS_DRACO:
            raise Error(grpc.StatusCode.UNIMPLEMENTED, "this copy of curvecast was built without Draco: use raw points")
        return v1.Encoding(draco=v1.DracoEncoding(position_bits=self.position_bits, normal_bits=self.normal_bits))


def as_view(view: View | int | None, options: Mapping[str, Any]) -> View:
    """Makes a View of a view or a number of points, with some fields replaced."""
    if view is None:
        return View(**options)
    return dataclasses.replace(view, **options) if isinstance(view, View) else View(points=view, **options)
