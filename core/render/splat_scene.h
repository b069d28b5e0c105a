// What the passes on OSMesa draw: a checked cloud in eye coordinates. Internal to core/render.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace curvecast {

/// One splat as the vertex shader reads it. Eye coordinates: x to the right, y up, the camera looks along -z; the unit is half
/// the diagonal of the cloud's bounding box.
struct SplatVertex {
  std::array<float, 3> center;
  float radius;
  std::array<float, 3> normal;  // unit length, or zero: facing the camera
  std::array<std::uint8_t, 4> color;
};

struct DotVertex {
  std::array<float, 3> center;
  std::array<std::uint8_t, 4> color;
};

struct SplatScene {
  int width = 0, height = 0, supersample = 1;
  float tan_half_x = 1, tan_half_y = 1;  // of half the angles of view
  float z_near = 0, z_far = 1;           // distances along the axis of view, 0 < z_near < z_far
  std::vector<SplatVertex> splats;
  std::vector<DotVertex> dots;  // none in kSurface
  float dot_diameter = 0;       // pixels
  float mean_radius = 0;        // of the splats
  bool has_normals = false, has_colors = false, ambient_occlusion = true;
  bool is_matte = false;  // flat, pale shading under dots
  std::array<std::uint8_t, 3> surface_color, background_top, background_bottom;
};

/// Runs the passes. ResourceExhausted when OSMesa has no memory, Internal with its message otherwise.
absl::StatusOr<Image> draw_splats(const SplatScene& scene);

}  // namespace curvecast
