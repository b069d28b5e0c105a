#include "core/render/splat_renderer.h"

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/render/disc_ends.h"
#include "core/render/eye_space.h"
#include "core/render/splat_scene.h"

namespace curvecast {
namespace {

std::array<std::uint8_t, 4> with_alpha(const Rgb8& color) { return {color[0], color[1], color[2], 255}; }

absl::Status check_options(const RenderOptions& options) {
  if (absl::Status status = check_picture_size(options); !status.ok()) return status;
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

double estimated_radius(const Box3d& box, std::size_t n) {
  const Vec3d d = box.max - box.min;
  const double area = 2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
  // Points on a line have no area; they share its length instead.
  return std::max(std::sqrt(area / static_cast<double>(n)), box.diagonal() / static_cast<double>(n));
}

void pack_splats(const SplatCloud& cloud, const EyeSpace& space, double all_radius, double radius_scale, bool use_colors,
                 SplatScene& scene) {
  const std::size_t n = cloud.positions.size();
  scene.splats.resize(n);
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0, sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    SplatVertex& splat = scene.splats[i];
    splat.center = to_floats(space.place(cloud.positions[i].cast<double>()));
    const double radius = (cloud.radii.empty() ? all_radius : cloud.radii[i]) * radius_scale * space.scale;
    splat.radius = static_cast<float>(std::min(radius, kMaxEyeDistance));
    splat.normal = cloud.normals.empty() ? std::array<float, 3>{} : to_floats(space.direction(cloud.normals[i]));
    splat.color = use_colors ? with_alpha(cloud.colors[i]) : std::array<std::uint8_t, 4>{};
    const double depth = -splat.center[2];
    nearest = std::min(nearest, depth - splat.radius);
    farthest = std::max(farthest, depth + splat.radius);
    sum += splat.radius;
  }
  scene.set_depths(nearest, farthest);
  scene.mean_radius = static_cast<float>(sum / static_cast<double>(n));
}

void pack_dots(std::span<const Vec3f> dots, std::span<const Rgb8> colors, const EyeSpace& space, const RenderOptions& options,
               SplatScene& scene) {
  scene.dots.resize(dots.size());
  for (std::size_t i = 0; i < dots.size(); ++i) {
    scene.dots[i] = {to_floats(space.place(dots[i].cast<double>())), with_alpha(colors.empty() ? options.dot_color : colors[i])};
  }
}

}  // namespace

absl::StatusOr<Image> render_splats(const SplatCloud& cloud, const RenderCamera& camera, const RenderOptions& options,
                                    std::span<const Vec3f> dots, std::span<const Rgb8> dot_colors) {
  if (absl::Status status = check_options(options); !status.ok()) return status;
  if (absl::Status status = check_cloud(cloud, dots, dot_colors); !status.ok()) return status;
  Box3d box;
  for (const Vec3f& p : cloud.positions) box.extend(p.cast<double>());
  const absl::StatusOr<EyeSpace> space = EyeSpace::make(camera, box);
  if (!space.ok()) return space.status();

  try {
    const bool is_dots = options.mode == RenderMode::kDots;
    SplatScene scene;
    set_up(options, camera, scene);
    scene.has_normals = !cloud.normals.empty();
    scene.has_colors = !is_dots && !cloud.colors.empty();
    scene.dot_diameter = static_cast<float>(options.dot_diameter);
    pack_splats(cloud, *space, estimated_radius(box, cloud.positions.size()), options.radius_scale, scene.has_colors, scene);
    if (scene.has_normals) find_disc_ends(scene.splats, cloud.crease_degrees);
    if (is_dots && dots.empty()) pack_dots(cloud.positions, cloud.colors, *space, options, scene);
    if (is_dots && !dots.empty()) pack_dots(dots, dot_colors, *space, options, scene);
    return draw_splats(scene);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("out of memory while rendering %d splats on %d x %d pixels",
                                                        cloud.positions.size(), options.width, options.height));
  }
}

}  // namespace curvecast
