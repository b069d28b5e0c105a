// A camera that a density looks through.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <numbers>

#include "core/base/vec.h"

namespace curvecast {

struct Camera {
  Vec3d eye = Vec3d::Zero();          // absolute coordinates, in the file's units
  Vec3d target = Vec3d(0, 0, -1);     // what lies in the picture's middle
  Vec3d up = Vec3d::UnitY();          // of any length
  double fov = std::numbers::pi / 4;  // vertical, radians; not used by an orthographic camera
  double height = 0;                  // of an orthographic picture, in the file's units; 0 = perspective
  double aspect = 1;                  // width over height
  double pixels = 1024;               // height of the picture

  bool is_orthographic() const { return height > 0; }
};

/// The most cameras of a density.
inline constexpr std::size_t kMaxCameras = 16;

/// Checks a camera. InvalidArgument names the field that is at fault: not finite, eye and target the same, up along the view, fov
/// outside (0, pi), a negative height, or aspect or pixels not above 0.
absl::Status check_camera(const Camera& camera);

/// Pixels for a length of 1 across the view: anywhere for an orthographic camera, else at a depth of 1. Precondition:
/// check_camera() finds nothing.
double pixels_at_unit_depth(const Camera& camera);

/// Directions of a camera's picture, unit vectors.
struct CameraAxes {
  Vec3d right, up, forward;
};
/// Returns the axes of a camera. Precondition: check_camera() finds nothing.
CameraAxes axes_of(const Camera& camera);

}  // namespace curvecast
