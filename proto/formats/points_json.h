// SPDX-License-Identifier: Apache-2.0
// Points as JSON, for programs that read nothing else.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// Returns an object with "count", "origin" (x, y, z) and a flat array of numbers for each column that is there, point after
/// point, as they come: positions (relative to the origin), normals, radii, colours, curvatures, ranks, faces, barycentric,
/// directions; and "scalars", an object with an array for each named number. Floats have as many digits as reading them back
/// exactly takes; what is not finite is null. InvalidArgument: as check_columns().
absl::StatusOr<std::string> make_points_json(const PointColumns& columns);

}  // namespace curvecast::formats
