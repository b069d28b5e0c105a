// What there is to draw of a parameter mesh: the discs in their squares, and the lines along which the surface was cut.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "client/lib/parameter_mesh.h"
#include "core/render/render_camera.h"
#include "core/render/uv_renderer.h"

namespace curvecast::cli {

/// Errors as of render_uv.
absl::StatusOr<UvPicture> draw_uv(const client::ParameterMesh& mesh, int width, int height);

inline constexpr Rgb8 kCutColor = {214, 40, 40};     // where the surface was cut open
inline constexpr Rgb8 kBorderColor = {29, 95, 176};  // where the mesh itself ends

/// Lines as rows of dots, so close that they touch on a picture.
struct LineDots {
  std::vector<Vec3f> positions;  // relative to `origin`
  std::vector<Rgb8> colors;
};

/// The discs' borders, every cut once although two sides of it are borders. `height`: of the picture, in pixels.
LineDots trace_cuts(const client::ParameterMesh& mesh, const RenderCamera& camera, int height, const Vec3d& origin);

}  // namespace curvecast::cli
