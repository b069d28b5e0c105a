// SPDX-License-Identifier: Apache-2.0
// Point files: .ply, .xyz and .pcd, by the ending of the name (.drc: see drc_file.h).
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "points.h"

namespace curvecast::client {

/// Replaces the file, all or nothing. Coordinates are absolute (origin + position).
///   .ply  binary little endian: x y z, then nx ny nz, red green blue, radius, curvature_min curvature_max, rank, face,
///         barycentric_2 barycentric_3, direction_min_x direction_min_y direction_min_z and scalar_NAME for each named value
///         where there are any; floats, but x y z doubles when the origin is not zero, colours uchar, and rank and face uint. The
///         other formats have none of what follows the radius.
///   .xyz  text: "x y z", "x y z nx ny nz" or "x y z nx ny nz red green blue" (0 to 255), in as many digits as reading them back
///         exactly takes; no radii
///   .pcd  v0.7, binary: x y z normal_x normal_y normal_z [rgb] radius, as PCL's point types are: floats, so that far from the
///         origin they are coarser than the points, and colours packed as 0xRRGGBB
/// InvalidArgument: another ending, or a column of another length than the positions. FailedPrecondition: cannot
/// be written. Messages start with the path.
absl::Status write_point_file(const std::string& path, const Points& points);

/// Reads .ply (text, binary little endian), .xyz and .pcd (text, binary), with at least x, y and z; normals, colours and radii
/// where the file has them, all else is skipped. The origin is zero, or the middle of the points when floats around zero would be
/// too coarse for the file's digits. A file may hold no points at all. NotFound; InvalidArgument: broken (truncated, a coordinate
/// not finite, ...), naming the path and the line or point; other errors as the file system has them.
absl::StatusOr<Points> read_point_file(const std::string& path);

}  // namespace curvecast::client
