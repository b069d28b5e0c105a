// Pictures of the parameter square: a parameter mesh, and the curve on it.
#pragma once

#include <absl/status/statusor.h>

#include "client/lib/curve.h"
#include "client/lib/parameter_mesh.h"
#include "core/render/uv_renderer.h"

namespace curvecast::cli {

/// Errors as of render_uv.
absl::StatusOr<UvPicture> draw_uv(const client::ParameterMesh& mesh, int width, int height);

struct CurvePicture {
  Image image;
  int tiles = 0;  // discs drawn
};

/// The curve of each disc, in the order of draw_uv(), over `mesh`: its own parameter mesh, or null for the curve alone. Errors as
/// of render_curves; InvalidArgument when the mesh has other discs.
absl::StatusOr<CurvePicture> draw_curve(const client::Curve& curve, const client::ParameterMesh* mesh, int width, int height);

}  // namespace curvecast::cli
