// Eye coordinates, in which everything is drawn. Internal to core/render.
#pragma once

#include <absl/status/statusor.h>

#include <array>

#include "core/base/vec.h"
#include "core/render/render_camera.h"

namespace curvecast {

/// Of a distance, in units of an EyeSpace: its square still is an ordinary float.
inline constexpr double kMaxEyeDistance = 1e12;

/// x to the right, y up, the camera looks along -z; the unit is half the diagonal of the box of what is drawn. In double up to
/// here: close-ups of large things keep their precision.
struct EyeSpace {
  Eigen::Matrix3d rotation;  // rows x, y, z
  Vec3d eye;                 // mesh units
  double scale;              // units of eye space per mesh unit

  /// InvalidArgument for a camera without a direction, and for one that is too far away for the size of the box.
  static absl::StatusOr<EyeSpace> make(const RenderCamera& camera, const Box3d& box);

  Vec3d place(const Vec3d& p) const { return rotation * ((p - eye) * scale); }
  /// Of unit length, or zero.
  Vec3d direction(const Vec3f& v) const { return rotation * v.cast<double>().stableNormalized(); }
};

inline std::array<float, 3> to_floats(const Vec3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace curvecast
