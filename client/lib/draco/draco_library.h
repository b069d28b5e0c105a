// SPDX-License-Identifier: Apache-2.0
// Decodes any Draco point cloud with Draco's own decoder.
#pragma once

#include <absl/status/status.h>

#include <string_view>

#include "client/lib/draco/draco_header.h"
#include "client/lib/draco/point_columns.h"

namespace curvecast::client {

/// Writes the points of a cloud with this header to columns of header.points elements: positions, and normals, radii (of the
/// valid range `radii`) and colours where they are wanted. InvalidArgument when Draco refuses it, it lacks what is wanted, or a
/// value is not finite.
absl::Status decode_with_draco(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii, const PointColumns& to);

}  // namespace curvecast::client
