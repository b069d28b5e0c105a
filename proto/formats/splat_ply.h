// SPDX-License-Identifier: Apache-2.0
// Splats as a PLY file in the layout of the paper's own program, which all programs for splats read.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/splats.h"

namespace curvecast::formats {

/// Returns a .ply file, binary little endian, of floats: x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity (the logarithm of its odds)
/// scale_0 scale_1 scale_2 (logarithms) rot_0 (w) rot_1 rot_2 rot_3 (x y z); spherical harmonics of degree 0. Axes are those of the mesh.
/// Positions are relative to the origin, for floats would be too coarse far out; where it is not zero, a "comment origin X Y Z" in
/// the header has it. InvalidArgument: as make_splats().
absl::StatusOr<std::string> make_splat_ply(const PointColumns& columns);

}  // namespace curvecast::formats
