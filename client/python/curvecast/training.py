# SPDX-License-Identifier: Apache-2.0
"""Training sets of meshes: points on the surface, on its sharp edges and in the space around it, from one seed."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast import density
from curvecast.points import Points, points_of
from curvecast.surface import FeaturePoints, Surface
from curvecast.v1 import curvecast_pb2 as v1

ROUNDS = 2  # in which nested points move apart


@dataclasses.dataclass(frozen=True, eq=False)
class SpacePoints:
    """Places in space."""

    positions: npt.NDArray[np.float64]  #: (N, 3), units
    signed_distance: npt.NDArray[np.float64]  #: (N,), units: below 0 inside

    @property
    def occupancy(self) -> npt.NDArray[np.bool_]:
        """(N,): whether each lies inside."""
        return self.signed_distance < 0


@dataclasses.dataclass(frozen=True, eq=False)
class TrainingSet:
    """What a network learns a shape from. None: not asked for."""

    uniform: Points | None = None  #: evenly on the surface; each prefix is an even set, too
    curved: Points | None = None  #: denser where the surface is curved; each prefix is such a set, too
    features: FeaturePoints | None = None  #: on sharp edges
    near: SpacePoints | None = None  #: about the surface
    space: SpacePoints | None = None  #: in the box

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """Returns all as arrays by names such as uniform_positions, near_signed_distance: for numpy.savez(). Positions are
        absolute: float64 where the mesh lies far from the origin, else float32."""
        out: dict[str, npt.NDArray[Any]] = {}
        sets = {
            "uniform": self.uniform,
            "curved": self.curved,
            "features": self.features.points if self.features is not None else None,
        }
        for name, points in sets.items():
            if points is None:
                continue
            out |= {f"{name}_{key.replace(' ', '_')}": column for key, column in points.columns().items() if key != "radii"}
            out[f"{name}_positions"] = points.world_positions() if points.origin.any() else points.positions
        if self.features is not None:
            out["features_side_normals"] = self.features.side_normals
        for name, places in {"near": self.near, "space": self.space}.items():
            if places is not None:
                out[f"{name}_positions"] = places.positions
                out[f"{name}_signed_distance"] = places.signed_distance.astype(np.float32)
                out[f"{name}_occupancy"] = places.occupancy
        return out

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes arrays() as .npz."""
        np.savez(path, **self.arrays())


def nested(
    surface: Surface, points: int, *, density: Sequence[v1.DensityTerm] | v1.DensityTerm = (), seed: int = 0, **options: Any
) -> Points:
    """Samples a set of which each prefix stands for the whole, instead of farthest points one by one: every prefix follows the
    density and is nearly as even as so many points can be. options: more fields of a View; relaxation_rounds is 2 without it."""
    attributes = dict.fromkeys([*options.pop("attributes", ()), "rank"])
    options = {"relaxation_rounds": ROUNDS} | options
    whole = surface.scatter(points, attributes=list(attributes), density=density, seed=seed, **options)
    columns = whole.columns()
    order = np.argsort(columns.pop("ranks"))
    return points_of(whole.origin, {name: column[order] for name, column in columns.items()})


def training_set(
    surface: Surface,
    *,
    uniform: int = 0,
    curved: int = 0,
    features: int = 0,
    near: int = 0,
    space: int = 0,
    n_per_face: int = 0,
    sigmas: Sequence[float] = (0.002, 0.01, 0.05),
    feature_degrees: float = 30,
    floor: float = 0.05,
    attributes: Sequence[str] = ("surface",),
    seed: int = 0,
) -> TrainingSet:
    """Makes a training set; the same mesh, numbers and seed give the same bytes.

    uniform: points evenly on the surface. n_per_face: at least so many of them on each face; those that lack are added behind.
    curved: points by curvature, flat parts at `floor` of the full density. features: points on edges at which faces turn by more
    than `feature_degrees`; none where there is no such edge. near: places off the surface along normals and across, at distances
    drawn from normal distributions of these `sigmas` in turn, in parts of the box's longest side. space: places in the box, a tenth
    larger on all sides. attributes: of the points on the surface, see View. Error FAILED_PRECONDITION: near or space, and the mesh
    has borders."""
    for name, count in {"uniform": uniform, "curved": curved, "features": features, "near": near, "space": space}.items():
        if count < 0:
            raise ValueError(f"{name} is {count}")
    if n_per_face > 0 and uniform < 1:
        raise ValueError("n_per_face adds to uniform points, of which there are none")
    generator = np.random.default_rng([seed, 0x5DF])
    made: dict[str, Any] = {}
    if uniform > 0:
        made["uniform"] = nested(surface, uniform, seed=seed, attributes=attributes)
        if n_per_face > 0:
            made["uniform"] = _filled(surface, made["uniform"], n_per_face, generator)
    if curved > 0:
        made["curved"] = nested(surface, curved, density=density.curvature(floor=floor), seed=seed, attributes=attributes)
    if features > 0:
        made["features"] = surface.features(features, feature_degrees, seed)
    low, high = (np.array([box.x, box.y, box.z]) for box in (surface.info.box_min, surface.info.box_max))
    side = (high - low).max()
    if near > 0:
        base = surface.scatter(near, seed=seed).world_positions()
        spread = side * np.resize(np.asarray(sigmas, np.float64), near)
        places = base + generator.standard_normal((near, 3)) * spread[:, None]
        made["near"] = SpacePoints(places, surface.signed_distance(places))
    if space > 0:
        places = _in_box(space, low - 0.1 * side, high + 0.1 * side, generator)
        made["space"] = SpacePoints(places, surface.signed_distance(places))
    return TrainingSet(**made)


def _in_box(
    n: int, low: npt.NDArray[np.float64], high: npt.NDArray[np.float64], generator: np.random.Generator
) -> npt.NDArray[np.float64]:
    """n places by the R3 sequence (Roberts 2018), which fills space more evenly than chance, moved by chance and wrapped round."""
    plastic = 1.22074408460575947536  # the root of x^4 = x + 1
    steps = plastic ** -np.arange(1.0, 4.0)
    return low + (high - low) * ((generator.random(3) + np.arange(1, n + 1)[:, None] * steps) % 1)


def _filled(surface: Surface, points: Points, n_per_face: int, generator: np.random.Generator) -> Points:
    """Adds points on faces of the repaired mesh that have fewer than n_per_face."""
    if points.faces is None or points.normals is None or points.barycentric is None:
        raise ValueError("n_per_face needs the attribute surface")
    mesh = surface.mesh()
    have = np.bincount(points.faces, minlength=int(mesh.faces.max()) + 1)
    lacking = np.maximum(n_per_face - have[mesh.faces], 0)
    faces = np.repeat(np.arange(len(mesh.faces)), lacking)
    if len(faces) == 0:
        return points
    # The i-th of each face, by the R2 sequence, folded into the triangle and moved by chance.
    number = np.arange(len(faces)) - np.repeat(np.cumsum(lacking) - lacking, lacking)
    golden = 1.32471795724474602596  # the root of x^3 = x + 1
    u = (generator.random((len(mesh.faces), 2))[faces] + (number[:, None] + 1) * golden ** -np.arange(1.0, 3.0)) % 1
    u[u.sum(axis=1) > 1] = 1 - u[u.sum(axis=1) > 1]
    corners = mesh.vertices[mesh.triangles[faces]]
    b, c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(b, c)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    places = corners[:, 0] + u[:, :1] * b + u[:, 1:] * c - points.origin
    own = {
        "positions": places.astype(np.float32),
        "normals": normals.astype(np.float32),
        "faces": mesh.faces[faces],
        "barycentric": _of_given(mesh.turned[faces], u).astype(np.float32),
    }
    columns = points.columns()
    kept = {name: np.concatenate([columns[name], more]) for name, more in own.items()}
    return points_of(points.origin, kept)


def _of_given(turned: npt.NDArray[np.bool_], weights: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Weights of the second and third corner as the faces were given."""
    return np.where(turned[:, None], weights[:, ::-1], weights)
