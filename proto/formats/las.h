// SPDX-License-Identifier: Apache-2.0
// Points as a LAS 1.4 file, which programs for laser scans read. Source: ASPRS, LAS Specification 1.4 - R15 (2019).
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// Returns a .las file, points in order of rank, in point format 7 where there are colours, else 6; no coordinate reference system.
/// Coordinates are whole multiples of a power of ten, the finest for which 31 bits hold the box: they are rounded by at most
/// 5e-9 of its longest side, less than a 32-bit float's own error there. What the format has no place for are its extra bytes, which
/// readers show by name: radius, NormalX NormalY NormalZ, curvature_min curvature_max, rank, face, barycentric_2 barycentric_3,
/// direction_min_x direction_min_y direction_min_z, and the named numbers, see column_name(); floats, but rank and face unsigned.
/// Names have 32 letters at most, and differ: of two that would be the same, the second ends in "_2" and so on.
/// InvalidArgument: as check_columns(); more named numbers than a record holds.
absl::StatusOr<std::string> make_las(const PointColumns& columns);

}  // namespace curvecast::formats
