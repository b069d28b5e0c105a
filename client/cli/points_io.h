// Point files of every kind that the command reads and writes, told apart by their ending.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "client/lib/drc_file.h"
#include "client/lib/points.h"
#include "proto/formats/glb_points.h"

namespace curvecast::cli {

/// OK for an ending that save_points() and load_points() know: .ply, .xyz, .pcd, .drc.
absl::Status check_points_ending(const std::string& path);
/// OK for an ending that save_points() knows: the above, .npy, .npz, .glb, .spz, .las.
absl::Status check_output_ending(const std::string& path);

struct SaveOptions {
  client::DrcOptions drc;
  /// A .ply or .glb holds splats: flat Gaussians for renderers of 3D Gaussian splatting. (A .spz holds nothing else.)
  bool splats = false;
  formats::GlbOptions glb;  // of points, not splats
};

/// Returns the columns of the points, which outlive them.
formats::PointColumns columns_of(const client::Points& points);

/// Whether the ending is that of files that may hold splats: .ply, .glb, .spz.
bool holds_splats(const std::string& path);

/// Whether save_points() puts points that have ranks in their order: in all files but .ply, .xyz, .pcd and .drc, and as splats.
/// So the first points of such a file are a coarser point set. Of a path, its ending counts.
bool is_in_order_of_rank(const std::string& path, bool splats);

/// Writes .ply, .xyz and .pcd as client/lib/point_file.h says, .drc as client/lib/drc_file.h does, and the others as
/// proto/formats: .npy, .npz (npy.h), .glb (glb_points.h), .las (las.h); as splats .spz (spz.h), .ply (splat_ply.h) and .glb
/// (glb_splats.h). InvalidArgument: splats in a file that holds none, points that the format cannot hold. Errors name the file.
absl::Status save_points(const std::string& path, const client::Points& points, const SaveOptions& options);
absl::StatusOr<client::Points> load_points(const std::string& path);

/// Whether a file given by the user holds points: .drc, .xyz and .pcd do, a .ply does when its header declares no faces.
/// Everything else is a mesh. NotFound or InvalidArgument when the file cannot be read.
absl::StatusOr<bool> holds_points(const std::string& path);

}  // namespace curvecast::cli
