// SPDX-License-Identifier: Apache-2.0
// Points as a PLY file.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// Returns a .ply file, binary little endian, points as they come: x y z, then nx ny nz, red green blue, radius, curvature_min
/// curvature_max, rank, face, barycentric_2 barycentric_3, direction_min_x direction_min_y direction_min_z and scalar_NAME for
/// each named number where there are any; floats, but x y z, which are in the frame of the mesh, doubles where the origin is not
/// zero, colours uchar, and rank and face uint. A name's blanks and letters beyond ASCII are "_". InvalidArgument: as
/// check_columns().
absl::StatusOr<std::string> make_ply(const PointColumns& columns);

}  // namespace curvecast::formats
