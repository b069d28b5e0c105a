#include "core/density/brush.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr std::size_t kStep = 1 << 20;  // vertices and blocks: some milliseconds

/// A dab relative to the curve's origin.
struct LocalDab {
  double x, y, z, scale, steepness;
  float factor;
};

/// Lays a dab over the vertices [begin, end).
CURVECAST_WIDE void lay(const LocalDab& dab, const SurfaceCurve& curve, std::size_t begin, std::size_t end, float* values) {
  const float *x = curve.x.data(), *y = curve.y.data(), *z = curve.z.data();
  for (std::size_t l = begin; l < end; ++l) {
    const double dx = (static_cast<double>(x[l]) - dab.x) * dab.scale;
    const double dy = (static_cast<double>(y[l]) - dab.y) * dab.scale;
    const double dz = (static_cast<double>(z[l]) - dab.z) * dab.scale;
    const double inside = (1 - std::sqrt(dx * dx + dy * dy + dz * dz)) * dab.steepness;
    const double t = inside > 0 ? (inside < 1 ? inside : 1.0) : 0.0;
    const auto weight = static_cast<float>(t * t * (3 - 2 * t));
    values[l] = weight < 1 ? values[l] + weight * (dab.factor - values[l]) : dab.factor;
  }
}

/// Calls visit(block) for each block that may have vertices within the dab.
template <typename Visit>
void for_each_reached(const CurveBlocks& blocks, const LocalDab& dab, double radius, const Visit& visit) {
  constexpr std::size_t kStretch = 64;
  const auto x = static_cast<float>(dab.x), y = static_cast<float>(dab.y), z = static_cast<float>(dab.z);
  // A little more, for what is rounded here.
  const auto reach = static_cast<float>(radius + 1e-6 * (radius + std::abs(dab.x) + std::abs(dab.y) + std::abs(dab.z)));
  for (std::size_t begin = 0; begin < blocks.size(); begin += kStretch) {
    const std::size_t end = std::min(begin + kStretch, blocks.size());
    const auto is_reached = [&](std::size_t b) {
      const float dx = blocks.x[b] - x, dy = blocks.y[b] - y, dz = blocks.z[b] - z, most = 1.00001f * (blocks.radius[b] + reach);
      return dx * dx + dy * dy + dz * dz <= most * most;
    };
    int any = 0;
    for (std::size_t b = begin; b < end; ++b) any |= is_reached(b) ? 1 : 0;
    if (any == 0) continue;
    for (std::size_t b = begin; b < end; ++b) {
      if (is_reached(b)) visit(b);
    }
  }
}

}  // namespace

absl::Status paint(const SurfaceCurve& curve, std::span<const Dab> dabs, std::span<float> values,
                   const ExecutionContext& context) {
  WorkLimit::Meter meter(context.limit);
  std::size_t done = kStep;  // since it was looked whether the paint is still wanted
  for (const Dab& dab : dabs) {
    if (done >= kStep) {
      done = 0;
      meter.settle();
      const absl::Status left = context.check_limit();
      if (!left.ok()) return absl::IsCancelled(left) ? left : absl::DeadlineExceededError("brush density: it takes too long");
    }
    const Vec3d centre = dab.centre - curve.origin;
    // At least: as good as a hard edge, without a division by zero.
    const LocalDab local{
        centre.x(), centre.y(), centre.z(), 1 / dab.radius, 1 / std::max(dab.falloff, 1e-12), static_cast<float>(dab.factor)};
    if (curve.blocks.size() == 0) {
      lay(local, curve, 0, values.size(), values.data());
      done += values.size();
      continue;
    }
    done += curve.blocks.size();
    for_each_reached(curve.blocks, local, dab.radius, [&](std::size_t b) {
      done += kBlockSize;
      lay(local, curve, b * kBlockSize, std::min((b + 1) * kBlockSize, values.size()), values.data());
    });
  }
  meter.settle();
  return absl::OkStatus();
}

float paint_scale(std::span<const Dab> dabs) {
  double largest = 1;
  for (const Dab& dab : dabs) largest = std::max(largest, dab.factor);
  return static_cast<float>(1 / largest);
}

}  // namespace curvecast
