# SPDX-License-Identifier: Apache-2.0
"""Terms of a density, which are multiplied; only ratios matter. Each function makes the message of the same name in the API."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast.v1 import curvecast_pb2 as v1

#: x, y, z
Vector = Sequence[float] | npt.NDArray[np.floating[Any]]


def vec3(values: Vector) -> v1.Vec3:
    x, y, z = (float(value) for value in values)
    return v1.Vec3(x=x, y=y, z=z)


def enum_name(enum: Any, prefix: str, name: str) -> str:
    """Makes PREFIX_NAME, the name of a value of `enum`, which is an enum of the API. ValueError: there is no such name; says which
    there are."""
    names = [key.removeprefix(f"{prefix}_").lower() for key, number in enum.items() if number != 0]
    if name not in names:
        raise ValueError(f"{prefix.lower()} is one of {', '.join(names)}, not {name!r}")
    return f"{prefix}_{name.upper()}"


def uniform() -> v1.DensityTerm:
    """The same everywhere."""
    return v1.DensityTerm(uniform=v1.UniformDensity())


def curvature(kind: str = "gauss", exponent: float | None = None, floor: float | None = None) -> v1.DensityTerm:
    """(floor + (1 - floor) min(|k| / k_ref, 1))^exponent with k by `kind`: gauss, mean or max. Defaults: exponent 1, floor 0.05."""
    term = v1.CurvatureDensity(kind=enum_name(v1.CurvatureKind, "CURVATURE_KIND", kind), exponent=exponent, floor=floor)
    return v1.DensityTerm(curvature=term)


def attribute(name: str) -> v1.DensityTerm:
    """A number that the mesh has for each vertex; negative ones and NaN count as 0."""
    return v1.DensityTerm(attribute=v1.AttributeDensity(name=name))


def brush(
    centres: Vector | Sequence[Vector] | npt.NDArray[Any], radius: float, factor: float, falloff: float | None = None
) -> v1.DensityTerm:
    """A stroke of paint: `factor` within `radius` (units) of one position or of each of several (N, 3), 1 elsewhere. A factor of 0
    takes points away. `falloff`: part of the radius over which the paint thins out, by default 0.5."""
    places = np.asarray(centres, dtype=np.float64).reshape(-1, 3)
    if len(places) == 0:
        return v1.DensityTerm(brush=v1.BrushDensity())
    path = (places[1:] - places[0]).ravel()
    stroke = v1.BrushStroke(centre=vec3(places[0]), radius=radius, factor=factor, falloff=falloff, path=path)
    return v1.DensityTerm(brush=v1.BrushDensity(strokes=[stroke]))


def paint(*brushes: v1.DensityTerm) -> v1.DensityTerm:
    """One term of several brushes, each over those before it, where terms of their own would be multiplied. A factor of 1 takes
    paint away."""
    strokes = [stroke for term in brushes for stroke in term.brush.strokes]
    return v1.DensityTerm(brush=v1.BrushDensity(strokes=strokes))


def expression(text: str) -> v1.DensityTerm:
    """A formula of x, y, z, nx, ny, nz, k1, k2, gauss, mean and attributes, in muParser's syntax: "1 + 9 * (z > 0)"."""
    return v1.DensityTerm(expression=v1.ExpressionDensity(text=text))


def view(s0: float | None = None) -> v1.DensityTerm:
    """Silhouettes: 1 - c + s0 where the cosine c between normal and direction to the eye is positive, else 0. Default: 0.1."""
    return v1.DensityTerm(view=v1.ViewDensity(s0=s0))


def distance(near: float = 0, far: float = 0, whole: bool = False, fall: str | None = None) -> v1.DensityTerm:
    """(near / clamp(d, near, far))^2, d from the eye, in units; 0: as near as the mesh's box, no far limit. `whole`: the density
    stays, and the number of points falls by the distance d of the middle of the mesh's box, by `fall`: inverse_square (the
    default), inverse, or linear, (far - d) / (far - near); near is then the box's diagonal by default."""
    law = None if fall is None else enum_name(v1.DistanceFall, "DISTANCE_FALL", fall)
    term = v1.DistanceDensity(near=near, far=far, fall=law)
    setattr(term, "global", whole)  # a keyword of Python
    return v1.DensityTerm(distance=term)


def frustum() -> v1.DensityTerm:
    """1 inside the camera's picture, else 0."""
    return v1.DensityTerm(frustum=v1.FrustumDensity())


def screen() -> v1.DensityTerm:
    """Even spacing in pixels of the camera's picture."""
    return v1.DensityTerm(screen=v1.ScreenDensity())


def picture() -> v1.DensityTerm:
    """Points where the camera's picture is wrong without them: as screen(), but in the picture only, and more at outlines, where
    the surface bends, and where its colour changes."""
    return v1.DensityTerm(picture=v1.PictureDensity())
