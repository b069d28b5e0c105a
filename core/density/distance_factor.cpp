#include "core/density/distance_factor.h"

#include <algorithm>
#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr double kLeastNear = 1e-3;  // diagonals
// A float's range, with room for squares: at such distances nothing changes any more.
constexpr double kEndless = 1e15;
constexpr float kSlack = 1e-5f;

struct Range {
  double near, far;  // frame lengths
};

Range range_of(const CameraFrame& frame, const DistanceTerm& term, double usual_near) {
  const double near = term.near > 0 ? term.near / frame.unit : usual_near;
  return {near, std::max(near, term.far / frame.unit)};
}

/// Returns the part of the points that are left at a distance, both in frame lengths.
double part_left(DistanceFall fall, const Range& range, double distance) {
  const double part = range.near / distance;
  switch (fall) {
    case DistanceFall::kInverseSquare:
      return part * part;
    case DistanceFall::kInverse:
      return part;
    case DistanceFall::kLinear:
      return range.far > range.near ? (range.far - distance) / (range.far - range.near) : 0;
  }
  return 1;
}

}  // namespace

DistanceFactor::DistanceFactor(const CameraFrame& frame, const DistanceTerm& term)
    : x_(frame.x), y_(frame.y), z_(frame.z), slope_(frame.slope), blur_(frame.blur), near_(1), far_(1) {
  if (frame.is_orthographic || term.global) return;
  const Range range = range_of(frame, term, std::max(kLeastNear / (frame.scale * frame.unit), frame.box_distance));
  near_ = static_cast<float>(std::clamp(range.near, 1 / kEndless, kEndless));
  far_ = static_cast<float>(std::clamp(range.far, 1 / kEndless, kEndless));
}

CURVECAST_WIDE void DistanceFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  const float *x = vertices.x, *y = vertices.y, *z = vertices.z;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, near = near_, far = far_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float below = distance < far ? distance : far;
    const float part = near / (below > near ? below : near);
    factor[i] *= part * part;
  }
}

CURVECAST_WIDE void DistanceFactor::multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor,
                                                    float* __restrict change) const {
  const float *x = blocks.x, *y = blocks.y, *z = blocks.z, *radius = blocks.radius;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, blur = blur_, near = near_, far = far_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz), reach = slope * radius[i] + blur;
    const float below = distance < far ? distance : far, middle = below > near ? below : near;
    const float nearer = distance - reach < far ? distance - reach : far, least = nearer > near ? nearer : near;
    const float part = near / middle, more = middle / least;
    factor[i] *= part * part;
    // From the middle it rises by more than it falls: the square of 1 / d bends upwards, and a clamp at `near` is exact.
    const float farther = distance + reach < far ? distance + reach : far, most = farther > near ? farther : near;
    const float less = middle / most;
    const float rise = more * more - 1, fall = 1 - less * less;
    change[i] = (1 + change[i]) * (1 + (rise > fall ? rise : fall) + kSlack) - 1;
  }
}

double point_scale(const Density& density, const Box3d& box) {
  double largest = 0;
  for (const Camera& camera : density.cameras) {
    const CameraFrame frame(camera, box.center(), box);
    double scale = 1;
    for (const DensityTerm& any : density.terms) {
      const auto* const term = std::get_if<DistanceTerm>(&any);
      if (term == nullptr || !term->global || frame.is_orthographic) continue;
      const Range range = range_of(frame, *term, 1 / (frame.scale * frame.unit));
      const double distance = ((camera.eye - box.center()) / frame.unit).stableNorm();
      if (distance > range.near) scale *= part_left(term->fall, range, std::min(distance, range.far));
    }
    largest = std::max(largest, scale);
  }
  return density.cameras.empty() ? 1 : largest;
}

}  // namespace curvecast
