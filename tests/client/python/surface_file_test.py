"""The surface of a session itself."""

import unittest

import numpy as np

import curvecast
from curvecast.surface_file import join_surface
from curvecast.v1 import curvecast_pb2 as v1
from fixture import ServerTest, sphere_obj

FILE = b"DRACO\2\2\1rest"


class SurfaceFileTest(ServerTest):
    def test_the_mesh_comes_whole(self) -> None:
        session = self.client.open(self.client.upload_bytes("ball.obj", sphere_obj(16).encode()), 2000)
        surface = session.surface()
        mesh = session.info.report.mesh
        self.assertEqual((surface.vertices, surface.triangles), (mesh.vertices, mesh.faces))
        self.assertEqual(surface.crease_degrees, 40)
        np.testing.assert_array_equal(surface.origin, 0)
        self.assertLess(len(surface.drc), len(session.surface(position_bits=20).drc))
        with self.assertRaises(curvecast.Error) as caught:
            session.surface(position_bits=3)
        self.assertEqual(caught.exception.code.name, "INVALID_ARGUMENT")

    def test_answers_that_make_no_sense(self) -> None:
        info = v1.GetSurfaceResponse(info=v1.SurfaceInfo(bytes=len(FILE)))
        chunk = v1.GetSurfaceResponse(chunk=FILE)
        self.assertEqual(join_surface(iter([info, chunk])).drc, FILE)
        for messages, why in [
            ([], "without its beginning"),
            ([chunk], "without its beginning"),
            ([info], f"0 bytes of a surface of {len(FILE)}"),
            ([info, info], "two beginnings"),
            ([info, chunk, chunk], f"of a surface of {len(FILE)}"),
            ([info, v1.GetSurfaceResponse(chunk=FILE.replace(b"\1", b"\0"))], "no mesh"),
            ([v1.GetSurfaceResponse(info=v1.SurfaceInfo())], "no mesh"),
        ]:
            with self.subTest(why=why), self.assertRaises(curvecast.Error) as caught:
                join_surface(iter(messages))
            self.assertEqual(caught.exception.code.name, "DATA_LOSS")
            self.assertIn(why, caught.exception.message)


if __name__ == "__main__":
    unittest.main()
