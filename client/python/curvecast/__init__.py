"""Curvecast in Python: bring a mesh to a server, open a session, take point sets as numpy arrays.

    client = curvecast.connect("127.0.0.1:50051")
    session = client.open(client.upload("bunny.obj"))
    points = session.sample(50_000, density=[curvecast.density.curvature()])
    points.positions  # (50000, 3) float32, relative to points.origin

Lengths are in the units of the mesh file, coordinates in its frame, times in seconds, angles in degrees. What a server or the
network refuses is a curvecast.Error with a gRPC status code. A client may be used from several threads at once.
"""

from curvecast import density
from curvecast.client import Client, connect
from curvecast.curve import Curve, CurveDisc
from curvecast.errors import Error
from curvecast.mesh import Mesh
from curvecast.neighbours import Neighbours
from curvecast.parameter_mesh import ParameterDisc, ParameterMesh
from curvecast.points import HAS_DRACO, Points
from curvecast.session import Session
from curvecast.surface import Surface
from curvecast.triangle_mesh import TriangleMesh
from curvecast.view import Camera, View
from curvecast.view_stream import Frame, HeldFrame, ViewStream

__all__ = [
    "HAS_DRACO",
    "Camera",
    "Client",
    "Curve",
    "CurveDisc",
    "Error",
    "Frame",
    "HeldFrame",
    "Mesh",
    "Neighbours",
    "ParameterDisc",
    "ParameterMesh",
    "Points",
    "Session",
    "Surface",
    "TriangleMesh",
    "View",
    "ViewStream",
    "connect",
    "density",
]
