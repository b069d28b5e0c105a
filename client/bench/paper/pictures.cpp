#include "client/bench/paper/pictures.h"

#include <utility>

#include "client/cli/parameter_picture.h"
#include "client/cli/render_scene.h"
#include "client/cli/surface_lines.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kFov = 30;  // degrees
constexpr double kDotsAcross = 200, kLinesAcross = 300;
constexpr std::size_t kScraps = 50;  // so many of them would be as large as the largest disc

/// Drops the discs that are next to nothing beside the largest: scraps of repair. `size`: how many parts a disc has.
template <typename Disc, typename Size>
void drop_scraps(std::vector<Disc>& discs, Size&& size) {
  std::size_t largest = 0;
  for (const Disc& disc : discs) largest = std::max<std::size_t>(largest, size(disc));
  std::erase_if(discs, [&](const Disc& disc) { return kScraps * size(disc) < largest; });
}

}  // namespace

absl::StatusOr<v1::Camera> Pictures::camera() const { return picture_camera_of({}, box_, 1); }

v1::Camera Pictures::camera_along(const Vec3d& direction, double diagonals) const {
  const Vec3d target = box_.center();
  return make_camera(target + diagonals * box_.diagonal() * direction, target, Vec3d(0, 1, 0), kFov);
}

absl::StatusOr<client::Points> Pictures::even_cloud() const {
  return mesh_.sample({}, {.points = mesh_.options().session_points});
}

absl::StatusOr<Image> Pictures::dots(const SampleFlags& sample, const v1::Camera& eye, const v1::Camera* view) const {
  absl::StatusOr<client::Points> cloud = even_cloud();
  if (!cloud.ok()) return cloud.status();
  const absl::StatusOr<client::Points> points = mesh_.sample({}, sample, view);
  if (!points.ok()) return points.status();
  Scene scene;
  const Vec3d offset = Vec3d(points->origin.data()) - Vec3d(cloud->origin.data());
  for (const auto& [x, y, z] : points->positions) scene.dots.emplace_back((offset + Vec3d(x, y, z)).cast<float>());
  scene.cloud = *std::move(cloud);
  scene.cloud.colours.clear();
  scene.camera = eye;
  scene.options.mode = RenderMode::kDots;
  scene.options.dot_diameter = std::max(1.0, side_ / kDotsAcross);
  return draw_scene(scene, {side_, side_});
}

absl::StatusOr<Image> Pictures::splats(std::uint64_t points) const {
  SampleFlags flags;
  flags.points = points;
  flags.sampler = "progressive";
  absl::StatusOr<client::Points> cloud = mesh_.sample({}, flags);
  if (!cloud.ok()) return cloud.status();
  absl::StatusOr<v1::Camera> eye = camera();
  if (!eye.ok()) return eye.status();
  Scene scene;
  scene.cloud = *std::move(cloud);
  scene.camera = *std::move(eye);
  return draw_scene(scene, {side_, side_});
}

absl::StatusOr<Image> Pictures::surface_curve(std::uint64_t points) const {
  const absl::StatusOr<client::Curve> curve = mesh_.curve({}, points);
  if (!curve.ok()) return curve.status();
  absl::StatusOr<client::Points> cloud = even_cloud();
  if (!cloud.ok()) return cloud.status();
  absl::StatusOr<v1::Camera> eye = camera();
  if (!eye.ok()) return eye.status();
  LineDots lines = trace_curve(
      *curve, {to_render_camera(*eye, Vec3d::Zero()), side_, box_.diagonal(), Vec3d(cloud->origin.data()), is_closed_});
  Scene scene;
  scene.cloud = *std::move(cloud);
  scene.cloud.colours.clear();
  scene.dots = std::move(lines.positions);
  scene.dot_colours = std::move(lines.colors);
  scene.camera = *std::move(eye);
  scene.options.mode = RenderMode::kDots;
  scene.options.dot_diameter = std::max(1.0, side_ / kLinesAcross);
  return draw_scene(scene, {side_, side_});
}

absl::StatusOr<Image> Pictures::curve(std::uint64_t points, const std::string& base_density) const {
  SessionFlags flags;
  if (!base_density.empty()) flags.base_density = {base_density};
  absl::StatusOr<client::Curve> curve = mesh_.curve(flags, points);
  if (!curve.ok()) return curve.status();
  drop_scraps(curve->discs, [](const client::CurveDisc& disc) { return disc.size(); });
  absl::StatusOr<CurvePicture> picture = draw_curve(*curve, nullptr, side_, side_);
  if (!picture.ok()) return picture.status();
  return std::move(picture->image);
}

absl::StatusOr<Image> Pictures::parameter_mesh() const {
  absl::StatusOr<client::ParameterMesh> mesh = mesh_.parameter_mesh();
  if (!mesh.ok()) return mesh.status();
  drop_scraps(mesh->discs, [](const client::ParameterDisc& disc) { return disc.triangles.size(); });
  absl::StatusOr<UvPicture> picture = draw_uv(*mesh, side_, side_);
  if (!picture.ok()) return picture.status();
  return std::move(picture->image);
}

}  // namespace curvecast::cli::bench
