// Point files of every kind that the command reads and writes, told apart by their ending.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "client/lib/drc_file.h"
#include "client/lib/points.h"

namespace curvecast::cli {

/// OK for an ending that save_points() knows: .ply, .xyz, .pcd, .drc.
absl::Status check_points_ending(const std::string& path);

/// Errors name the file. `drc` applies to .drc only.
absl::Status save_points(const std::string& path, const client::Points& points, const client::DrcOptions& drc);
absl::StatusOr<client::Points> load_points(const std::string& path);

/// Whether a file given by the user holds points: .drc, .xyz and .pcd do, a .ply does when its header declares no faces.
/// Everything else is a mesh. NotFound or InvalidArgument when the file cannot be read.
absl::StatusOr<bool> holds_points(const std::string& path);

}  // namespace curvecast::cli
