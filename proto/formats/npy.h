// SPDX-License-Identifier: Apache-2.0
// Points as arrays of NumPy: format 1.0 of https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// Returns a .npy file: the positions in the frame of the mesh, shape (N, 3), in order of rank; float64 where the origin is not zero,
/// else float32. InvalidArgument: as check_columns().
absl::StatusOr<std::string> make_npy(const PointColumns& columns);

/// Returns a .npz file, uncompressed: the columns that are there, in order of rank, under the names of curvecast.Points in Python:
/// positions (as above), normals, radii, colours, curvatures, ranks, faces, barycentric, directions, and "scalar NAME" for each named
/// number, see column_name() (of two that would be of one name, the second ends in "_2" and so on). InvalidArgument: as
/// check_columns(). ResourceExhausted: not enough memory.
absl::StatusOr<std::string> make_npz(const PointColumns& columns);

}  // namespace curvecast::formats
