# SPDX-License-Identifier: Apache-2.0
"""Small pictures of points as PNG files, drawn with numpy: for notebooks, where neither a server nor OpenGL may be at hand.

Each point is the disc that it stands for, seen along parallel lines; the nearest disc of a pixel is the one that shows. Two by two
samples make a pixel.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from curvecast.points import Points

WIDTH, HEIGHT = 320, 240  # pixels
MOST_POINTS = 30_000  # that are drawn; of more every so many, which along the curve are even as well
MOST_BYTES = 75_000  # of a picture; 100,000 as text in a page

SAMPLES = 2  # along each side of a pixel
MARGIN = 0.04  # of the picture's sides
LEAST_RADIUS, LARGEST_RADIUS = 0.75, 24.0  # of a disc, samples
LEAST_EXTENT = 0.01  # in the picture, of the largest: a line of points that is seen from its end is not blown up
CLAY = (214, 196, 178)  # points without colours
AMBIENT = 0.35  # light from everywhere
# From above, to the right of the z axis, in whose direction most models look; y is up.
TURN_DEGREES, ABOVE_DEGREES = 30, 20
LIGHT = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])  # towards it: right, up, to the eye

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]


def draw(points: Points) -> bytes | None:
    """Draws points in their colours, or as of clay, before nothing. At most MOST_BYTES. None: there is no finite point."""
    chosen = _choose(points)
    if len(chosen) == 0:
        return None
    turned = points.positions[chosen].astype(np.float64) @ _eye().T
    least, most = turned.min(axis=0), turned.max(axis=0)
    length = float((most - least).max()) or 1.0  # in which everything is measured from here on
    extent = (most - least) / length
    size = np.array([WIDTH, HEIGHT], dtype=np.float64) * SAMPLES
    scale = float(((1 - 2 * MARGIN) * size / np.maximum(extent[:2], LEAST_EXTENT)).min())
    seen = (turned - 0.5 * (least + most)) / length * scale
    seen[:, 0] += 0.5 * size[0]
    seen[:, 1] = 0.5 * size[1] - seen[:, 1]  # rows go down
    if points.radii is None:
        a, b, c = extent
        radii = np.full(len(chosen), np.sqrt(2 * (a * b + b * c + c * a) / len(chosen)))
    else:
        radii = np.clip(np.nan_to_num(points.radii[chosen].astype(np.float64)), 0, length) / length
        radii *= np.sqrt(len(points) / len(chosen))
    normals = None
    if points.normals is not None:
        normals = np.nan_to_num(points.normals[chosen].astype(np.float64)) @ _eye().T
        normals *= np.where(normals[:, 2:] < 0, -1, 1)  # both sides of a surface are shown
    colours = np.tile(np.array(CLAY, np.float64), (len(chosen), 1)) if points.colours is None else points.colours[chosen]
    nearest = _nearest(seen, np.clip(radii * scale, LEAST_RADIUS, LARGEST_RADIUS), normals)
    pixels = _average(nearest, colours * _light(seen, normals)[:, None])
    data = encode_png(pixels)
    return data if len(data) <= MOST_BYTES else encode_png(pixels[::2, ::2])


def encode_png(pixels: Pixels) -> bytes:
    """Makes a PNG file of (rows, columns, 4) values: red, green, blue (sRGB) and alpha, which is not multiplied in."""
    height, width = pixels.shape[:2]
    rows = pixels.reshape(height, 4 * width)
    filtered = np.full((height, 1 + 4 * width), 2, np.uint8)  # 2: each row as a difference to the one above
    filtered[0, 1:] = rows[0]
    filtered[1:, 1:] = rows[1:] - rows[:-1]

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(filtered.tobytes(), 9)) + chunk(b"IEND", b"")
    )


def _choose(points: Points) -> npt.NDArray[np.intp]:
    """Finds which points are drawn."""
    step = -(-len(points) // MOST_POINTS) or 1
    chosen = np.arange(0, len(points), step)
    finite: npt.NDArray[np.intp] = chosen[np.isfinite(points.positions[chosen]).all(axis=1)]
    return finite


def _eye() -> Floats:
    """Makes the matrix whose rows are right, up and to the eye."""
    turn, above = np.radians(TURN_DEGREES), np.radians(ABOVE_DEGREES)
    to_eye = np.array([np.sin(turn) * np.cos(above), np.sin(above), np.cos(turn) * np.cos(above)])
    right = np.array([np.cos(turn), 0, -np.sin(turn)])
    return np.stack([right, np.cross(to_eye, right), to_eye])


def _light(seen: Floats, normals: Floats | None) -> Floats:
    """Tells how bright each point is, 0 to 1: by its normal or, without one, by how near it is."""
    if normals is not None:
        return np.asarray(AMBIENT + (1 - AMBIENT) * np.maximum(normals @ LIGHT, 0))
    depths = seen[:, 2]
    return np.asarray(1 - 0.5 * (depths.max() - depths) / max(np.ptp(depths), np.finfo(np.float64).tiny))


def _nearest(seen: Floats, radii: Floats, normals: Floats | None) -> npt.NDArray[np.int64]:
    """Finds the disc that shows in each sample; -1: none. seen: columns and rows of samples, and nearness in their unit."""
    covered = list(_cover(seen, radii, normals))
    samples, depths, owners = (np.concatenate(parts) for parts in zip(*covered, strict=True))
    order = np.argsort(depths, kind="stable")  # of what is written to one sample, the last stays
    nearest = np.full(HEIGHT * WIDTH * SAMPLES**2, -1, np.int64)
    nearest[samples[order]] = owners[order]
    return nearest


def _cover(seen: Floats, radii: Floats, normals: Floats | None) -> Iterator[tuple[npt.NDArray[Any], ...]]:
    """Lists which samples discs cover, how near they are there, and whose they are: discs of one size at a time."""
    columns, rows = WIDTH * SAMPLES, HEIGHT * SAMPLES
    reach = np.ceil(radii).astype(np.int64)
    for half in np.unique(reach):
        owners = np.flatnonzero(reach == half)
        steps = np.arange(-half, half + 1)
        down, across = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
        column = np.floor(seen[owners, :1]).astype(np.int64) + across
        row = np.floor(seen[owners, 1:2]).astype(np.int64) + down
        x, y = column + 0.5 - seen[owners, :1], seen[owners, 1:2] - row - 0.5
        if normals is None:
            z = np.zeros_like(x)
        else:
            lean = normals[owners]
            z = -(lean[:, :1] * x + lean[:, 1:2] * y) / np.maximum(lean[:, 2:], 0.05)
        inside = (x * x + y * y + z * z <= radii[owners, None] ** 2) | ((across == 0) & (down == 0))
        inside &= (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        depths = seen[owners, 2:] + z
        yield (row * columns + column)[inside], depths[inside], np.broadcast_to(owners[:, None], inside.shape)[inside]


def _average(nearest: npt.NDArray[np.int64], colours: Floats) -> Pixels:
    """Makes pixels of samples."""
    there = (nearest >= 0)[:, None]
    samples = np.hstack([np.where(there, colours[nearest], 0), there])
    sums = samples.reshape(HEIGHT, SAMPLES, WIDTH, SAMPLES, 4).sum(axis=(1, 3))
    covered = sums[..., 3:]
    colour = sums[..., :3] / np.maximum(covered, 1)
    pixels: Pixels = np.rint(np.concatenate([colour, 255 * covered / SAMPLES**2], axis=-1)).astype(np.uint8)
    return pixels
