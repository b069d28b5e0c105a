// SPDX-License-Identifier: Apache-2.0
// Points as a binary glTF file.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

struct GlbOptions {
  /// KHR_mesh_quantization: positions on a lattice of 65,535 steps along the longest side of the box, normals of 8 bits. Else floats.
  bool quantise = true;
  /// EXT_meshopt_compression, for readers that have its decoder. With `quantise`, radii are rounded by 2^-15 of themselves.
  bool compress = false;
};

/// Returns a .glb file: one primitive of points in order of rank, with POSITION, NORMAL, COLOR_0 (linear, 16 bits) and _RADIUS (float,
/// units) where there are any, and nothing else of the columns; axes are those of the mesh. The node's translation holds the
/// origin, so that positions keep their digits far out. Without compression points lie one after the other: the first bytes are the first points.
/// InvalidArgument: as check_columns(); no points. ResourceExhausted: more than 4 GiB.
absl::StatusOr<std::string> make_glb(const PointColumns& columns, const GlbOptions& options);

}  // namespace curvecast::formats
