"""The curve of a session, and the parameter mesh under it."""

import unittest
from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import numpy as np

import curvecast
from curvecast.curve import decode_curve
from curvecast.parameter_mesh import decode_parameter_mesh
from curvecast.v1 import curvecast_pb2 as v1
from fixture import ServerTest, sphere_obj


class CurveTest(ServerTest):
    mesh: ClassVar[curvecast.Mesh]
    session: ClassVar[curvecast.Session]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.mesh = cls.client.upload_bytes("ball.obj", sphere_obj(16).encode())
        cls.session = cls.client.open(cls.mesh, 2000)

    def test_the_curve_covers_the_sphere(self) -> None:
        curve = self.session.curve()
        report = self.session.info.report
        self.assertEqual((curve.revision, len(curve.discs)), (self.session.info.curve_revision, report.discs))
        self.assertEqual(sum(map(len, curve.discs)), report.curve_vertices)
        self.assertAlmostEqual(sum(disc.areas.sum(dtype=float) for disc in curve.discs), report.mesh.area, delta=1e-4)
        for disc in curve.discs:
            away = disc.positions + curve.origin
            np.testing.assert_allclose(np.linalg.norm(away, axis=1), 1, atol=0.02)
            np.testing.assert_allclose(np.linalg.norm(disc.normals, axis=1), 1, atol=1e-3)
            self.assertTrue(((disc.normals * away).sum(axis=1) > 0.9).all())
            centres, sides = disc.centres(), 0.5 ** disc.levels.astype(float)
            self.assertTrue((centres > 0).all() and (centres < 1).all())
            # One quad after the other, most of them side by side.
            steps = np.abs(np.diff(centres, axis=0)).max(axis=1)
            self.assertGreater((steps <= np.maximum(sides[1:], sides[:-1])).mean(), 0.9)

    def test_the_parameter_mesh_is_one_of_discs(self) -> None:
        parameter_mesh = self.client.parameter_mesh(self.mesh)
        self.assertEqual(len(parameter_mesh.discs), parameter_mesh.info.discs)
        faces: set[int] = set()
        for disc in parameter_mesh.discs:
            faces.update(disc.faces.tolist())
            a, b, c = (disc.uv[disc.triangles[:, corner]] for corner in range(3))
            twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
            self.assertTrue((twice > 0).all())
            self.assertAlmostEqual(twice.sum() / 2, 1, delta=1e-9)
            self.assertTrue(disc.border_cuts.all())  # a sphere has no border of its own
            self.assertEqual(len(np.unique(disc.border)), len(disc.border))
        self.assertEqual(len(faces), parameter_mesh.info.mesh.file_polygons)

    def test_answers_that_make_no_sense(self) -> None:
        def refused(decode: Callable[[Iterator[Any]], object], *messages: object) -> None:
            with self.assertRaises(curvecast.Error) as caught:
                decode(iter(messages))
            self.assertEqual(caught.exception.code.name, "DATA_LOSS")

        def chunk(disc: int, count: int, **columns: bytes) -> v1.GetCurveResponse:
            data = {
                "positions": bytes(12 * count),
                "normals": bytes(6 * count),
                "areas": bytes(4 * count),
                "cells": bytes(8 * count),
                "levels": bytes(count),
            }
            info = v1.CurveInfo(discs=1, curve_vertices=2)
            return v1.GetCurveResponse(info=info, chunk=v1.CurveChunk(disc=disc, count=count, **data | columns))

        self.assertEqual(len(decode_curve(iter([chunk(0, 2)])).discs[0]), 2)
        self.assertEqual(len(decode_curve(iter([chunk(0, 1), chunk(0, 1)])).discs[0]), 2)
        for messages in (
            [chunk(0, 1)],
            [chunk(0, 3)],
            [chunk(1, 2)],
            [chunk(0, 2), chunk(1, 0)],
            [chunk(0, 2, areas=bytes(4))],
            [chunk(0, 2, positions=bytes(23))],
            [chunk(0, 2, levels=b"\x1f\x00")],
            [v1.GetCurveResponse(info=v1.CurveInfo(discs=1))],
        ):
            refused(decode_curve, *messages)
        info = v1.ParameterMeshInfo(discs=1, mesh=v1.MeshInfo(faces=1))
        good = v1.ParameterDiscChunk(positions=bytes(72), uv=bytes(48), triangles=bytes(12), faces=bytes(4), area_ratios=bytes(8))
        self.assertEqual(len(decode_parameter_mesh(iter([v1.GetParameterMeshResponse(info=info, chunk=good)])).discs), 1)
        for change in ({"uv": b""}, {"faces": b"\x01\0\0\0"}, {"triangles": b"\x03" + bytes(11)}, {"border": bytes(4)}):
            bad = v1.ParameterDiscChunk()
            bad.CopyFrom(good)
            for name, value in change.items():
                setattr(bad, name, value)
            refused(decode_parameter_mesh, v1.GetParameterMeshResponse(info=info, chunk=bad))


if __name__ == "__main__":
    unittest.main()
