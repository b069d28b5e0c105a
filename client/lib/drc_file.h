// SPDX-License-Identifier: Apache-2.0
// Draco point cloud files (.drc), as Draco's own draco_decoder opens them.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <string_view>

#include "points.h"

namespace curvecast::client {

struct DrcOptions {
  int position_bits = 16;  // 1 .. 30 per coordinate, over the largest side of the points' box
  int normal_bits = 10;    // 2 .. 30, octahedral
};

/// InvalidArgument: options out of range.
absl::Status check_drc_options(const DrcOptions& options);

/// The bytes of a file with one point cloud in absolute coordinates: POSITION, NORMAL, the splat radius as in v1.DracoPoints with
/// its range as metadata (see draco_header.h), COLOR of three bytes; all but the first where the points have them. The order is
/// kept. InvalidArgument for no points or options out of range; Internal with Draco's message.
absl::StatusOr<std::string> make_drc(Points points, const DrcOptions& options);

/// The points of such a file's bytes, or of any other Draco point cloud with positions. InvalidArgument when it is broken.
absl::StatusOr<Points> parse_drc(std::string_view bytes);

/// Reads a file; errors name it. NotFound, InvalidArgument.
absl::StatusOr<Points> read_drc(const std::string& path);

}  // namespace curvecast::client
