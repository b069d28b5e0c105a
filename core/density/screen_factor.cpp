#include "core/density/screen_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/simd.h"
#include "core/density/density.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kSlack = 1e-5f;

/// Pixels per area: of what is seen with this cosine, at this distance from the eye and depth along the view.
[[gnu::always_inline]] inline float covered(float weight, float cosine, float distance, float depth) {
  const float counted = fast_max(fast_min(cosine, 1.0f), static_cast<float>(kLeastSlant));
  return fast_min(pixels_on_screen(weight, counted, distance, depth), kMostOnScreen);
}

/// Pixels per length of the file, of what is seen squarely at a depth of 1 in the frame.
double pixels_per_length(const Camera& camera, const CameraFrame& frame) {
  return frame.is_orthographic ? pixels_at_unit_depth(camera) : pixels_at_unit_depth(camera) / frame.unit;
}

}  // namespace

ScreenWeights screen_weights(std::span<const Camera> cameras, std::span<const CameraFrame> frames) {
  double largest = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const double nearest = frames[i].is_orthographic ? 1 : std::max(kNearPlane, frames[i].box_distance);
    largest = std::max(largest, pixels_per_length(cameras[i], frames[i]) / nearest);
  }
  ScreenWeights out{{}, largest * largest};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const double ratio = pixels_per_length(cameras[i], frames[i]) / largest;
    out.of_camera.push_back(static_cast<float>(ratio * ratio));
  }
  return out;
}

ScreenFactor::ScreenFactor(const CameraFrame& frame, float weight)
    : x_(frame.x),
      y_(frame.y),
      z_(frame.z),
      slope_(frame.slope),
      blur_(frame.is_orthographic ? 0 : frame.blur),
      depth_(frame.depth),
      depth_reach_(frame.depth_reach),
      depth_blur_(frame.is_orthographic ? 0 : frame.blur),
      weight_(weight) {}

CURVECAST_WIDE void ScreenFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  const float *x = vertices.x, *y = vertices.y, *z = vertices.z;
  const Snorm16 *nx = vertices.nx, *ny = vertices.ny, *nz = vertices.nz;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, weight = weight_;
  const AffineForm form = depth_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float square = dx * dx + dy * dy + dz * dz;
    const float facing = dx * nx[i] + dy * ny[i] + dz * nz[i];
    const float distance = std::sqrt(square > kLeastSquare ? square : kLeastSquare);
    const float depth = form.at(x[i], y[i], z[i]);
    const float value = covered(weight, facing / distance, distance, depth);
    factor[i] *= fast_min(facing, depth) > 0 ? value : 0.0f;
  }
}

CURVECAST_WIDE void ScreenFactor::multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor,
                                                  float* __restrict change) const {
  const float *x = blocks.x, *y = blocks.y, *z = blocks.z, *radius = blocks.radius;
  const float *nx = blocks.nx, *ny = blocks.ny, *nz = blocks.nz, *spread = blocks.spread;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, weight = weight_;
  const float blur = blur_, depth_reach = depth_reach_, depth_blur = depth_blur_;
  const AffineForm form = depth_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float square = dx * dx + dy * dy + dz * dz;
    const float distance = std::sqrt(square > kLeastSquare ? square : kLeastSquare), inverse = 1 / distance;
    const float cosine = (dx * nx[i] + dy * ny[i] + dz * nz[i]) * inverse;
    const float reach = slope * radius[i] + blur;
    const float sine = reach * inverse;  // as in SilhouetteFactor
    const float most = spread[i] + (sine < 0.5f ? 1.05f * sine : 2.0f) + kCosineBlur;
    const float depth = form.at(x[i], y[i], z[i]), deep = depth_reach * radius[i] + depth_blur;
    const float value = covered(weight, cosine, distance, depth);
    const float high = covered(weight, cosine + most, distance + reach, depth - deep);
    const float low = covered(weight, cosine - most, fast_max(distance - reach, 0.0f), depth + deep);
    const bool is_hidden = cosine < -most || depth < -deep;
    const bool is_seen = cosine > most && depth > deep && spread[i] < kSmoothSpread;
    const float rise = high / value, fall = 2 - low / value;
    factor[i] *= is_hidden ? 0.0f : is_seen ? value : high;
    change[i] = (1 + change[i]) * (is_hidden ? 1.0f : is_seen ? fast_max(rise, fall) + kSlack : kInfinity) - 1;
  }
}

}  // namespace curvecast
