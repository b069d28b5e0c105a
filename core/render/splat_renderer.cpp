#include "core/render/splat_renderer.h"

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>

#include "core/render/splat_scene.h"

namespace curvecast {
namespace {

// OSMesa clamps larger viewports without a word.
constexpr int kMaxSide = 16384;
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 26;
// Of a distance, in half diagonals of the cloud: its square still is an ordinary float.
constexpr double kMaxExtent = 1e12;

std::array<std::uint8_t, 4> with_alpha(const Rgb8& color) { return {color[0], color[1], color[2], 255}; }

absl::Status check_options(const RenderOptions& options) {
  const int s = options.supersample;
  if (s < 1 || s > 4) return absl::InvalidArgumentError(absl::StrFormat("supersample is %d: it must be 1 .. 4", s));
  const auto out_of_range = [s](int side) { return side < 1 || side > kMaxSide / s; };
  if (out_of_range(options.width) || out_of_range(options.height)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cannot render %d x %d pixels: with supersample %d each side must be 1 .. %d", options.width,
                        options.height, s, kMaxSide / s));
  }
  if (std::int64_t{options.width} * options.height * s * s > kMaxSamples) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "cannot render %d x %d pixels with supersample %d: more than %d samples in all; ask for fewer pixels or a "
        "smaller supersample",
        options.width, options.height, s, kMaxSamples));
  }
  if (!std::isfinite(options.radius_scale) || options.radius_scale <= 0) {
    return absl::InvalidArgumentError(absl::StrFormat("radius_scale is %g: it must be > 0", options.radius_scale));
  }
  if (!(options.dot_diameter >= 1 && options.dot_diameter <= 64)) {
    return absl::InvalidArgumentError(absl::StrFormat("dot_diameter is %g: it must be 1 .. 64 pixels", options.dot_diameter));
  }
  return absl::OkStatus();
}

absl::Status check_cloud(const SplatCloud& cloud, std::span<const Vec3f> dots, std::span<const Rgb8> dot_colors) {
  const std::size_t n = cloud.positions.size();
  if (n == 0) return absl::InvalidArgumentError("cannot render an empty cloud");
  if (n > std::numeric_limits<std::int32_t>::max() || dots.size() > std::numeric_limits<std::int32_t>::max()) {
    return absl::InvalidArgumentError(absl::StrFormat("cannot render %d splats: at most 2^31 - 1", std::max(n, dots.size())));
  }
  const auto check_size = [n](const char* what, std::size_t size) {
    if (size == 0 || size == n) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrFormat("the cloud has %d positions but %d %s", n, size, what));
  };
  if (absl::Status status = check_size("normals", cloud.normals.size()); !status.ok()) return status;
  if (absl::Status status = check_size("radii", cloud.radii.size()); !status.ok()) return status;
  if (absl::Status status = check_size("colours", cloud.colors.size()); !status.ok()) return status;
  if (!dot_colors.empty() && dot_colors.size() != dots.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("there are %d dots but %d colours of dots", dots.size(), dot_colors.size()));
  }

  const auto check_finite = [](const char* what, std::span<const Vec3f> values) {
    const auto bad = std::find_if(values.begin(), values.end(), [](const Vec3f& v) { return !v.allFinite(); });
    if (bad == values.end()) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrFormat("the %s of splat %d is not finite: (%g, %g, %g)", what,
                                                      bad - values.begin(), bad->x(), bad->y(), bad->z()));
  };
  if (absl::Status status = check_finite("position", cloud.positions); !status.ok()) return status;
  if (absl::Status status = check_finite("normal", cloud.normals); !status.ok()) return status;
  if (absl::Status status = check_finite("dot", dots); !status.ok()) return status;
  const auto bad = std::find_if(cloud.radii.begin(), cloud.radii.end(), [](float r) { return !(std::isfinite(r) && r >= 0); });
  if (bad != cloud.radii.end()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the radius of splat %d is %g: it must be finite and >= 0", bad - cloud.radii.begin(), *bad));
  }
  return absl::OkStatus();
}

// The camera's rotation: rows x (right), y (up), z (from target to eye).
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

// Eye coordinates in a unit of the cloud's size. In double up to here: close-ups of large clouds keep their precision.
struct EyeTransform {
  Eigen::Matrix3d rotation;
  Vec3d eye;
  double scale;

  std::array<float, 3> operator()(const Vec3f& p) const { return to_array(rotation * ((p.cast<double>() - eye) * scale)); }
  std::array<float, 3> direction(const Vec3f& v) const { return to_array(rotation * v.cast<double>().stableNormalized()); }

  static std::array<float, 3> to_array(const Vec3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  }
};

double estimated_radius(const Box3d& box, std::size_t n) {
  const Vec3d d = box.max - box.min;
  const double area = 2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
  // Points on a line have no area; they share its length instead.
  return std::max(std::sqrt(area / static_cast<double>(n)), box.diagonal() / static_cast<double>(n));
}

void pack_splats(const SplatCloud& cloud, const EyeTransform& to_eye, double all_radius, double radius_scale, bool use_colors,
                 SplatScene& scene) {
  const std::size_t n = cloud.positions.size();
  scene.splats.resize(n);
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0, sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    SplatVertex& splat = scene.splats[i];
    splat.center = to_eye(cloud.positions[i]);
    const double radius = (cloud.radii.empty() ? all_radius : cloud.radii[i]) * radius_scale * to_eye.scale;
    splat.radius = static_cast<float>(std::min(radius, kMaxExtent));
    splat.normal = cloud.normals.empty() ? std::array<float, 3>{} : to_eye.direction(cloud.normals[i]);
    splat.color = use_colors ? with_alpha(cloud.colors[i]) : std::array<std::uint8_t, 4>{};
    const double depth = -splat.center[2];
    nearest = std::min(nearest, depth - splat.radius);
    farthest = std::max(farthest, depth + splat.radius);
    sum += splat.radius;
  }
  // Splats around the eye are cut away; a thousandth of the way to the back keeps depths distinct.
  scene.z_far = static_cast<float>(std::max(farthest * 1.01, 1e-6));
  scene.z_near = static_cast<float>(std::max(nearest * 0.99, 1e-4 * scene.z_far));
  scene.mean_radius = static_cast<float>(sum / static_cast<double>(n));
}

void pack_dots(std::span<const Vec3f> dots, std::span<const Rgb8> colors, const EyeTransform& to_eye,
               const RenderOptions& options, SplatScene& scene) {
  scene.dots.resize(dots.size());
  for (std::size_t i = 0; i < dots.size(); ++i) {
    scene.dots[i] = {to_eye(dots[i]), with_alpha(colors.empty() ? options.dot_color : colors[i])};
  }
}

}  // namespace

absl::StatusOr<Image> render_splats(const SplatCloud& cloud, const RenderCamera& camera, const RenderOptions& options,
                                    std::span<const Vec3f> dots, std::span<const Rgb8> dot_colors) {
  if (absl::Status status = check_options(options); !status.ok()) return status;
  if (absl::Status status = check_cloud(cloud, dots, dot_colors); !status.ok()) return status;
  const absl::StatusOr<Eigen::Matrix3d> rotation = camera_rotation(camera);
  if (!rotation.ok()) return rotation.status();

  Box3d box;
  for (const Vec3f& p : cloud.positions) box.extend(p.cast<double>());
  const double diagonal = box.diagonal();
  // A cloud that is one point has the size of its distance.
  const double size = diagonal > 0 ? diagonal : (camera.eye - box.center()).norm();
  if (!(size > 0)) return absl::InvalidArgumentError("the camera's eye is on the only point of the cloud");
  const EyeTransform to_eye{*rotation, camera.eye, 2 / size};
  if (!((camera.eye - box.center()).norm() * to_eye.scale < kMaxExtent)) {
    return absl::InvalidArgumentError("the camera's eye is too far from the cloud for its size");
  }

  try {
    const bool is_dots = options.mode == RenderMode::kDots;
    SplatScene scene;
    scene.width = options.width;
    scene.height = options.height;
    scene.supersample = options.supersample;
    const double tan_half = std::tan(camera.vertical_fov_degrees * (std::numbers::pi / 360));
    scene.tan_half_y = static_cast<float>(tan_half);
    scene.tan_half_x = static_cast<float>(tan_half * options.width / options.height);
    scene.has_normals = !cloud.normals.empty();
    scene.has_colors = !is_dots && !cloud.colors.empty();
    scene.ambient_occlusion = options.ambient_occlusion;
    scene.is_matte = is_dots && options.matte_under_dots;
    scene.surface_color = options.surface_color.value_or(scene.is_matte ? Rgb8{244, 242, 238} : Rgb8{208, 184, 160});
    scene.background_top = options.background_top;
    scene.background_bottom = options.background_bottom;
    scene.dot_diameter = static_cast<float>(options.dot_diameter);
    pack_splats(cloud, to_eye, estimated_radius(box, cloud.positions.size()), options.radius_scale, scene.has_colors, scene);
    if (is_dots && dots.empty()) pack_dots(cloud.positions, cloud.colors, to_eye, options, scene);
    if (is_dots && !dots.empty()) pack_dots(dots, dot_colors, to_eye, options, scene);
    return draw_splats(scene);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("out of memory while rendering %d splats on %d x %d pixels",
                                                        cloud.positions.size(), options.width, options.height));
  }
}

}  // namespace curvecast
