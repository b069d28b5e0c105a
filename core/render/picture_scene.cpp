#include "core/render/picture_scene.h"

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curvecast {
namespace {

// OSMesa clamps larger viewports without a word.
constexpr int kMaxSide = 16384;
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 26;

}  // namespace

void PictureScene::set_depths(double nearest, double farthest) {
  // What is around the eye is cut away; a ten thousandth of the way to the back keeps depths distinct.
  z_far = static_cast<float>(std::max(farthest * 1.01, 1e-6));
  z_near = static_cast<float>(std::max(nearest * 0.99, 1e-4 * z_far));
}

absl::Status check_picture_size(const RenderOptions& options) {
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
  return absl::OkStatus();
}

void set_up(const RenderOptions& options, const RenderCamera& camera, PictureScene& scene) {
  scene.width = options.width;
  scene.height = options.height;
  scene.supersample = options.supersample;
  const double tan_half = std::tan(camera.vertical_fov_degrees * (std::numbers::pi / 360));
  scene.tan_half_y = static_cast<float>(tan_half);
  scene.tan_half_x = static_cast<float>(tan_half * options.width / options.height);
  scene.ambient_occlusion = options.ambient_occlusion;
  scene.is_matte = options.mode == RenderMode::kDots && options.matte_under_dots;
  scene.surface_color = options.surface_color.value_or(scene.is_matte ? Rgb8{244, 242, 238} : Rgb8{208, 184, 160});
  scene.background_top = options.background_top;
  scene.background_bottom = options.background_bottom;
}

}  // namespace curvecast
