// SPDX-License-Identifier: Apache-2.0
// Splats as a binary glTF file. Source: Khronos, KHR_gaussian_splatting, as ratified.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/splats.h"

namespace curvecast::formats {

/// Returns a .glb file with the splats in order of rank, all of floats, and COLOR_0, by which readers that do not know the extension draw
/// points. Splats lie one after the other: the first bytes are the first splats. Axes are those of the mesh; the node's translation
/// holds the origin. InvalidArgument: as make_splats(); no points. ResourceExhausted: more than 4 GiB.
absl::StatusOr<std::string> make_glb_splats(const PointColumns& columns);

}  // namespace curvecast::formats
