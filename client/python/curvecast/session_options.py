# SPDX-License-Identifier: Apache-2.0
"""What a mesh is prepared for."""

from __future__ import annotations

from collections.abc import Sequence

from curvecast.density import enum_name
from curvecast.v1 import curvecast_pb2 as v1


def session_options(
    points: int,
    omega: float,
    density: Sequence[v1.DensityTerm],
    parameteriser: str,
    mapper: str,
    area: str,
    seed: int,
    chart_faces: int,
    crease_degrees: float | None,
) -> v1.SessionOptions:
    """Makes the message of the API. ValueError: a name that the API does not know."""
    return v1.SessionOptions(
        max_points=points,
        omega=omega,
        density=density,
        mapper=enum_name(v1.Mapper, "MAPPER", mapper),
        parameteriser=enum_name(v1.Parameteriser, "PARAMETERISER", parameteriser),
        area_element=enum_name(v1.AreaElement, "AREA_ELEMENT", area),
        seed=seed,
        chart_faces=chart_faces,
        crease_degrees=crease_degrees,
    )
