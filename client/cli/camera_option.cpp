#include "client/cli/camera_option.h"

#include "core/render/render_camera.h"

namespace curvecast::cli {
namespace {

v1::Vec3 to_proto(const Vec3d& v) {
  v1::Vec3 proto;
  proto.set_x(v.x());
  proto.set_y(v.y());
  proto.set_z(v.z());
  return proto;
}

}  // namespace

Vec3d to_vec(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

v1::Camera make_camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_degrees) {
  v1::Camera camera;
  *camera.mutable_eye() = to_proto(eye);
  *camera.mutable_target() = to_proto(target);
  *camera.mutable_up() = to_proto(up);
  camera.set_vertical_fov_degrees(fov_degrees);
  return camera;
}

absl::StatusOr<v1::Camera> resolve_camera(const CameraOption& option, const Box3d& box, double aspect) {
  FitOptions fit;
  fit.aspect = aspect;
  fit.vertical_fov_degrees = option.fov();
  const RenderCamera whole = fit_camera(box, fit);
  return terms::complete_camera(option, to_proto(box.center()), make_camera(whole.eye, whole.target, whole.up, option.fov()));
}

}  // namespace curvecast::cli
