"""Meshes as arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def torus(rings: int = 60, sides: int = 40) -> tuple[Floats, Ints]:
    """A closed torus of 2 * rings * sides triangles, with normals that point outwards."""
    u, v = np.meshgrid(np.arange(rings) * 2 * np.pi / rings, np.arange(sides) * 2 * np.pi / sides, indexing="ij")
    vertices = np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij")
    a, b = i * sides + j, (i + 1) % rings * sides + j
    c, d = (i + 1) % rings * sides + (j + 1) % sides, i * sides + (j + 1) % sides
    return vertices.reshape(-1, 3), np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def places(vertices: Floats, faces: Ints, of: npt.NDArray[np.uint32], weights: npt.NDArray[np.float32]) -> Floats:
    """Where points lie, by their faces and the weights of the second and third corners."""
    corners = vertices[faces[of]]
    second, third = weights[:, :1].astype(np.float64), weights[:, 1:].astype(np.float64)
    lie: Floats = (1 - second - third) * corners[:, 0] + second * corners[:, 1] + third * corners[:, 2]
    return lie


def loosened(vertices: Floats, faces: Ints) -> tuple[Floats, Ints]:
    """The mesh as repair has work with it: each face has vertices of its own, some are turned, some are there twice, one has no
    area."""
    loose = vertices[faces].reshape(-1, 3)
    own = np.arange(len(loose)).reshape(-1, 3)
    turned = np.random.default_rng(5).random(len(own)) < 0.3
    own[turned] = own[turned][:, [0, 2, 1]]
    return loose, np.concatenate([own[:7], own[:5], [[0, 0, 1]], own[7:]])


def write_off(path: str, vertices: Floats, faces: Ints) -> None:
    """Writes all digits."""
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in faces.tolist())


def cube() -> tuple[Floats, Ints]:
    """A cube of side 1 about the origin, of twelve triangles."""
    vertices = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return vertices, np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
