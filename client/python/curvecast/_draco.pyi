# SPDX-License-Identifier: Apache-2.0
"""The Draco decoder of the C++ client: see _draco.cpp."""

def decode(data: bytes, radius_min: float, radius_max: float, count: int, /) -> tuple[bytes, bytes, bytes, bytes]:
    """Returns positions, normals, radii and colours. ValueError: bytes that do not hold exactly `count` points."""
