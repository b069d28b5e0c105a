# SPDX-License-Identifier: Apache-2.0
"""Curvecast in Python: point sets of meshes as numpy arrays, in this process or from a server.

    points = curvecast.Surface(vertices, faces).sample(16_384, attributes=["surface"])
    points.positions, points.faces, points.barycentric  # (16384, 3), (16384,), (16384, 2): of the faces given

    client = curvecast.connect("127.0.0.1:50051")
    session = client.open(client.upload("bunny.obj"))
    points = session.sample(50_000, density=[curvecast.density.curvature()])
    points.positions  # (50000, 3) float32, relative to points.origin

Lengths are in the units of the mesh file, coordinates in its frame, times in seconds, angles in degrees. What a server or the
network refuses is a curvecast.Error with a gRPC status code. A client may be used from several threads at once.
"""

from curvecast import density, notebook
from curvecast.client import Client, connect
from curvecast.curve import Curve, CurveDisc
from curvecast.errors import Error
from curvecast.frame import Frame
from curvecast.mesh import Mesh
from curvecast.neighbours import Neighbours
from curvecast.parameter_mesh import ParameterDisc, ParameterMesh
from curvecast.points import HAS_DRACO, Points
from curvecast.session import Session
from curvecast.surface import HAS_LOCAL, FeaturePoints, RepairedMesh, Surface, SurfaceStream, read, scatter, scatter_file
from curvecast.surface_file import SurfaceFile
from curvecast.training import SpacePoints, TrainingSet, nested, training_set
from curvecast.triangle_mesh import TriangleMesh
from curvecast.view import Camera, View
from curvecast.view_stream import HeldFrame, ViewStream

__all__ = [
    "HAS_DRACO",
    "HAS_LOCAL",
    "Camera",
    "Client",
    "Curve",
    "CurveDisc",
    "Error",
    "FeaturePoints",
    "Frame",
    "HeldFrame",
    "Mesh",
    "Neighbours",
    "ParameterDisc",
    "ParameterMesh",
    "Points",
    "RepairedMesh",
    "Session",
    "SpacePoints",
    "Surface",
    "SurfaceFile",
    "SurfaceStream",
    "TrainingSet",
    "TriangleMesh",
    "View",
    "ViewStream",
    "connect",
    "density",
    "nested",
    "notebook",
    "read",
    "scatter",
    "scatter_file",
    "training_set",
]
