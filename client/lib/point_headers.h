// SPDX-License-Identifier: Apache-2.0
// The headers of point files.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "client/lib/point_table.h"

namespace curvecast::client {

/// The table points into `bytes`. InvalidArgument, naming the line, when the header is malformed, or says what is not supported:
/// big endian and lists in or before the vertices of a PLY, compressed PCD.
absl::StatusOr<PointTable> parse_ply_points(std::string_view bytes);
absl::StatusOr<PointTable> parse_pcd_points(std::string_view bytes);
/// The first line that is not empty or a comment tells the columns: x y z, from six on x y z nx ny nz, nine also red green
/// blue (0 to 255); more are skipped.
absl::StatusOr<PointTable> parse_xyz_points(std::string_view bytes);

}  // namespace curvecast::client
