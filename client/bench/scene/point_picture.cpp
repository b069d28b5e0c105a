#include "client/bench/scene/point_picture.h"

#include <vector>

namespace curvecast::cli::bench {
namespace {

constexpr double kFov = 45;  // degrees: the API's default

Vec3d to_vec(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

RenderCamera camera_from(const v1::Camera& camera, const Vec3d& origin) {
  return {to_vec(camera.eye()) - origin, to_vec(camera.target()) - origin, to_vec(camera.up()),
          camera.vertical_fov_degrees() > 0 ? camera.vertical_fov_degrees() : kFov};
}

absl::StatusOr<Image> draw_points(const client::Points& points, const v1::Camera& camera, const RenderOptions& options,
                                  bool has_colours, double crease_degrees) {
  std::vector<Vec3f> positions, normals;
  std::vector<Rgb8> colours;
  for (const auto& [x, y, z] : points.positions) positions.emplace_back(x, y, z);
  for (const auto& [x, y, z] : points.normals) normals.emplace_back(x, y, z);
  if (has_colours) colours = points.colours;
  const Vec3d origin(points.origin[0], points.origin[1], points.origin[2]);
  return render_splats({positions, normals, points.radii, colours, crease_degrees}, camera_from(camera, origin), options);
}

}  // namespace curvecast::cli::bench
