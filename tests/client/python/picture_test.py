"""Small pictures of points."""

import struct
import unittest
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from curvecast.picture import ABOVE_DEGREES, CLAY, HEIGHT, MOST_BYTES, MOST_POINTS, TURN_DEGREES, WIDTH, draw, encode_png
from curvecast.points import Points
from fixture import present


def decode(data: bytes) -> npt.NDArray[np.int64]:
    """(rows, columns, 4) of a PNG file as encode_png() makes them; checks every chunk."""
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    chunks: dict[bytes, bytes] = {}
    at = 8
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size) == (zlib.crc32(kind + body),)
        chunks[kind] = body
        at += 12 + size
    assert list(chunks) == [b"IHDR", b"IDAT", b"IEND"]
    width, height, *rest = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    assert rest == [8, 6, 0, 0, 0]
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, 1 + 4 * width)
    assert (rows[:, 0] == 2).all()
    return np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8).reshape(height, width, 4).astype(np.int64)


def ball(count: int, **columns: Any) -> Points:
    """Even points of a ball of radius 2 about (7, 8, 9)."""
    height = 1 - (2 * np.arange(count) + 1) / count
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    across = np.sqrt(1 - height**2)
    normals = np.stack([across * np.cos(turn), height, across * np.sin(turn)], axis=1).astype("<f4")
    radii = np.full(count, 2 * np.sqrt(4 * np.pi / count), "<f4")
    return Points(np.array([7.0, 8, 9]), 2 * normals, **{"normals": normals, "radii": radii, **columns})


class PictureTest(unittest.TestCase):
    def assert_ball(self, data: bytes | None) -> npt.NDArray[np.int64]:
        pixels = decode(present(data))
        self.assertEqual(pixels.shape, (HEIGHT, WIDTH, 4))
        rows, columns = np.indices((HEIGHT, WIDTH)) + 0.5
        away = np.hypot(columns - WIDTH / 2, rows - HEIGHT / 2) / (0.46 * HEIGHT)
        self.assertTrue((pixels[away < 0.97, 3] == 255).all())  # closed
        self.assertTrue((pixels[away > 1.05, 3] == 0).all())  # and nothing else
        return pixels

    def test_a_ball_is_a_disc_that_is_lit_from_above(self) -> None:
        pixels = self.assert_ball(draw(ball(16_384)))
        self.assertGreater(pixels[HEIGHT // 3, WIDTH // 2, 0], 1.5 * pixels[HEIGHT * 5 // 6, WIDTH // 2, 0])
        lit = pixels[pixels[..., 3] == 255, :3]
        np.testing.assert_allclose(lit / lit[:, :1], np.broadcast_to(np.array(CLAY) / CLAY[0], lit.shape), atol=0.02)

    def test_of_many_points_every_so_many_are_drawn_larger(self) -> None:
        self.assert_ball(draw(ball(5 * MOST_POINTS + 1)))

    def test_without_normals_and_radii_what_is_near_is_bright(self) -> None:
        pixels = decode(present(draw(ball(16_384, normals=None, radii=None))))
        middle, edge = pixels[HEIGHT // 2, WIDTH // 2], pixels[HEIGHT // 2, WIDTH // 2 + 105]
        self.assertEqual((middle[3], edge[3]), (255, 255))
        self.assertGreater(middle[0], edge[0] + 20)

    def test_what_is_nearer_hides_what_is_behind_and_colours_are_those_of_points(self) -> None:
        turn, above = np.radians(TURN_DEGREES), np.radians(ABOVE_DEGREES)
        to_eye = np.array([np.sin(turn) * np.cos(above), np.sin(above), np.cos(turn) * np.cos(above)])
        for order in (slice(None), slice(None, None, -1)):  # whichever comes first
            positions = np.stack([to_eye, -to_eye])[order].astype("<f4")
            colours = np.array([[255, 0, 0], [0, 0, 255]], np.uint8)[order]
            pixels = decode(present(draw(Points(np.zeros(3), positions, colours=colours, radii=np.ones(2, "<f4")))))
            shown = pixels[HEIGHT // 2, WIDTH // 2]
            self.assertEqual((shown[0] > 200, shown[1], shown[2], shown[3]), (True, 0, 0, 255))

    def test_both_sides_are_lit(self) -> None:
        away, towards = (draw(ball(1000, normals=side * present(ball(1000).normals))) for side in (-1, 1))
        self.assertEqual(away, towards)

    def test_pictures_have_a_largest_size(self) -> None:
        noise = np.random.default_rng(1).integers(0, 256, (MOST_POINTS, 3), dtype=np.uint8)
        positions = np.random.default_rng(2).uniform(-1, 1, (MOST_POINTS, 3)).astype("<f4")
        data = present(draw(Points(np.zeros(3), positions, colours=noise, radii=np.full(MOST_POINTS, 0.02, "<f4"))))
        self.assertLessEqual(len(data), MOST_BYTES)
        self.assertEqual(decode(data).shape, (HEIGHT // 2, WIDTH // 2, 4))

    def test_odd_points(self) -> None:
        nan, inf = float("nan"), float("inf")
        nothing: list[list[list[float]]] = [[], [[nan, 0, 0]], [[0, inf, 0], [0, 0, -inf]]]
        for positions in nothing:
            self.assertIsNone(draw(Points(np.zeros(3), np.array(positions, "<f4").reshape(-1, 3))))
        something: list[list[list[float]]] = [
            [[1, 2, 3]],
            [[1, 2, 3]] * 5,
            [[0, 0, 0], [nan, 0, 0]],
            [[0, 0, 0], [3e38, 0, 0]],
            [[0, 0, 0], [1e-40, 0, 0]],
        ]
        for positions in something:
            count = len(positions)
            for radii in (0, 1, nan, inf):
                for normal in ([0, 0, 1], [0, 0, 0], [nan, 0, 0]):
                    points = Points(
                        np.zeros(3), np.array(positions, "<f4"), np.full((count, 3), normal, "<f4"), np.full(count, radii, "<f4")
                    )
                    with self.subTest(positions=positions, radii=radii, normal=normal), np.errstate(all="raise", under="ignore"):
                        self.assertGreater(decode(present(draw(points)))[..., 3].max(), 0)

    def test_every_pixel_comes_back(self) -> None:
        pixels = np.random.default_rng(3).integers(0, 256, (5, 7, 4), dtype=np.uint8)
        np.testing.assert_array_equal(decode(encode_png(pixels)), pixels)


if __name__ == "__main__":
    unittest.main()
