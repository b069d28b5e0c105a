// Draws points as a view's camera sees them.
#pragma once

#include <absl/status/statusor.h>

#include "client/lib/points.h"
#include "core/base/image.h"
#include "core/render/splat_renderer.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli::bench {

/// Returns the camera of a view for what lies relative to an origin.
RenderCamera camera_from(const v1::Camera& camera, const Vec3d& origin);

/// Draws points as a surface, in their own colours where they have any and `has_colours`. `crease_degrees`: as of SplatCloud.
/// Errors as of render_splats().
absl::StatusOr<Image> draw_points(const client::Points& points, const v1::Camera& camera, const RenderOptions& options,
                                  bool has_colours, double crease_degrees = SplatCloud{}.crease_degrees);

}  // namespace curvecast::cli::bench
