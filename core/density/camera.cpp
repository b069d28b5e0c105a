#include "core/density/camera.h"

#include <absl/strings/str_format.h>

#include <cmath>

namespace curvecast {
namespace {

constexpr double kLeastSine = 1e-9;  // of the angle between up and the view

// Returns the unit vector of the same direction; lengths from the smallest to the largest doubles neither vanish nor overflow.
Vec3d direction(const Vec3d& v) { return (v / v.cwiseAbs().maxCoeff()).normalized(); }

Vec3d half_way_ahead(const Camera& camera) { return 0.5 * camera.target - 0.5 * camera.eye; }

}  // namespace

absl::Status check_camera(const Camera& camera) {
  if (!camera.eye.allFinite()) return absl::InvalidArgumentError("eye is not finite");
  if (!camera.target.allFinite()) return absl::InvalidArgumentError("target is not finite");
  if (!camera.up.allFinite()) return absl::InvalidArgumentError("up is not finite");
  const Vec3d ahead = half_way_ahead(camera);
  if (ahead.isZero(0)) return absl::InvalidArgumentError("eye and target are the same point");
  if (camera.up.isZero(0)) return absl::InvalidArgumentError("up has no length");
  if (direction(ahead).cross(direction(camera.up)).norm() < kLeastSine) {
    return absl::InvalidArgumentError("up is along the view; choose another direction");
  }
  if (!(camera.fov > 0 && camera.fov < std::numbers::pi)) {
    return absl::InvalidArgumentError(absl::StrFormat("fov = %g; it must lie between 0 and pi", camera.fov));
  }
  if (!(camera.height >= 0 && std::isfinite(camera.height))) {
    return absl::InvalidArgumentError(absl::StrFormat("height = %g; it must be 0 or more, and finite", camera.height));
  }
  if (!(camera.aspect > 0 && std::isfinite(camera.aspect))) {
    return absl::InvalidArgumentError(absl::StrFormat("aspect = %g; it must be above 0, and finite", camera.aspect));
  }
  if (!(camera.pixels > 0 && std::isfinite(camera.pixels))) {
    return absl::InvalidArgumentError(absl::StrFormat("pixels = %g; they must be above 0, and finite", camera.pixels));
  }
  return absl::OkStatus();
}

double pixels_at_unit_depth(const Camera& camera) {
  return camera.is_orthographic() ? camera.pixels / camera.height : 0.5 * camera.pixels / std::tan(0.5 * camera.fov);
}

CameraAxes axes_of(const Camera& camera) {
  CameraAxes axes;
  axes.forward = direction(half_way_ahead(camera));
  axes.right = direction(axes.forward.cross(direction(camera.up)));
  axes.up = axes.right.cross(axes.forward);
  return axes;
}

}  // namespace curvecast
