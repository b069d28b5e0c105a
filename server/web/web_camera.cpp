#include "server/web/web_camera.h"

#include "core/render/render_camera.h"
#include "server/convert/convert.h"

namespace curvecast::server {
namespace {

Box3d box_of(const v1::MeshInfo& mesh) {
  const auto corner = [](const v1::Vec3& v) { return Vec3d(v.x(), v.y(), v.z()); };
  return {corner(mesh.box_min()), corner(mesh.box_max())};
}

}  // namespace

v1::Camera whole_view(const v1::MeshInfo& mesh, double aspect, double fov_degrees, double margin) {
  FitOptions fit;
  fit.aspect = aspect;
  fit.margin = margin;
  fit.vertical_fov_degrees = fov_degrees;
  const RenderCamera camera = fit_camera(box_of(mesh), fit);
  v1::Camera made;
  *made.mutable_eye() = to_proto(camera.eye);
  *made.mutable_target() = to_proto(camera.target);
  *made.mutable_up() = to_proto(camera.up);
  made.set_vertical_fov_degrees(camera.vertical_fov_degrees);
  return made;
}

absl::StatusOr<v1::Camera> complete_camera(const terms::CameraTerm& term, const v1::MeshInfo& mesh, double aspect) {
  const v1::Camera whole = whole_view(mesh, aspect, term.fov(), FitOptions().margin);
  return terms::complete_camera(term, to_proto(Vec3d(box_of(mesh).center())), whole);
}

}  // namespace curvecast::server
