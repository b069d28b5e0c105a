// What all pictures of a shaded surface have in common. Internal to core/render.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>

#include "core/render/render_camera.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

struct PictureScene {
  int width = 0, height = 0, supersample = 1;
  float tan_half_x = 1, tan_half_y = 1;  // of half the angles of view
  float z_near = 0, z_far = 1;           // distances along the axis of view in eye space, 0 < z_near < z_far
  float mean_radius = 0;                 // of the splats
  bool has_normals = false, has_colors = false, ambient_occlusion = true;
  bool is_matte = false;  // flat, pale shading under dots
  Rgb8 surface_color, background_top, background_bottom;

  /// Nothing before `nearest` and behind `farthest`, distances in eye space, is to be seen.
  void set_depths(double nearest, double farthest);
};

/// Checks the size of the picture that the options ask for.
absl::Status check_picture_size(const RenderOptions& options);

/// Sets what options and camera say. Precondition: both have been checked.
void set_up(const RenderOptions& options, const RenderCamera& camera, PictureScene& scene);

}  // namespace curvecast
