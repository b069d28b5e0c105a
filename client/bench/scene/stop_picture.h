// A picture of what a view's points show, beside what there is to see.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "client/lib/points.h"
#include "core/mesh/triangle_mesh.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli::bench {

/// Draws points as a surface, on the left, and the mesh itself, on the right, each of viewport's size, and writes a PNG file.
/// Returns the coverage: the share of the pixels in the mesh's outline that the points cover. Errors of render_splats() and of
/// files.
absl::StatusOr<double> draw_stop(const client::Points& points, const TriangleMesh& mesh, const v1::Camera& camera,
                                 const v1::Viewport& viewport, const std::string& path);

}  // namespace curvecast::cli::bench
