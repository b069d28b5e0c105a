#include "core/render/eye_space.h"

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <cmath>

namespace curvecast {
namespace {

absl::StatusOr<Eigen::Matrix3d> camera_rotation(const RenderCamera& camera) {
  const double fov = camera.vertical_fov_degrees;
  if (!camera.eye.allFinite() || !camera.target.allFinite() || !camera.up.allFinite() || !std::isfinite(fov)) {
    return absl::InvalidArgumentError("the camera has a coordinate that is not finite");
  }
  if (!(fov > 0 && fov < 180)) {
    return absl::InvalidArgumentError(absl::StrFormat("the camera's angle of view is %g degrees: it must be > 0 and < 180", fov));
  }
  const Vec3d back = camera.eye - camera.target;
  const double distance = back.stableNorm();
  if (!(distance > 0) || !std::isfinite(distance)) {
    return absl::InvalidArgumentError("the camera has no direction: eye and target are the same point or too far apart");
  }
  Eigen::Matrix3d rotation;
  const Vec3d z = back / distance;
  const Vec3d x = camera.up.stableNormalized().cross(z);
  if (!(x.norm() > 1e-9)) return absl::InvalidArgumentError("the camera's up vector is zero or along its direction of view");
  rotation.row(0) = x.normalized();
  rotation.row(1) = z.cross(Vec3d(rotation.row(0)));
  rotation.row(2) = z;
  return rotation;
}

}  // namespace

absl::StatusOr<EyeSpace> EyeSpace::make(const RenderCamera& camera, const Box3d& box) {
  const absl::StatusOr<Eigen::Matrix3d> rotation = camera_rotation(camera);
  if (!rotation.ok()) return rotation.status();
  const double diagonal = box.diagonal();
  // What is one point has the size of its distance.
  const double size = diagonal > 0 ? diagonal : (camera.eye - box.center()).norm();
  if (!(size > 0)) return absl::InvalidArgumentError("the camera's eye is on the only point that there is to draw");
  const EyeSpace space{*rotation, camera.eye, 2 / size};
  if (!((camera.eye - box.center()).norm() * space.scale < kMaxEyeDistance)) {
    return absl::InvalidArgumentError("the camera's eye is too far away for the size of what is drawn");
  }
  return space;
}

}  // namespace curvecast
