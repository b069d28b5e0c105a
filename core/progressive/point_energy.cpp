#include "core/progressive/point_energy.h"

#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

/// Adds Askey's function (1 - r)^2 of the distance r in ranges. Like that of the distance itself, its spectrum falls with the
/// third power of the frequency; unlike the distance, it ends.
CURVECAST_WIDE void add_kernel(std::span<const float> x, std::span<const float> y, std::span<const float> z, const float* p,
                               float inverse_range, float* sum) {
  const float px = p[0], py = p[1], pz = p[2];
  const float *xs = x.data(), *ys = y.data(), *zs = z.data();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float dx = xs[i] - px, dy = ys[i] - py, dz = zs[i] - pz;
    const float rest = 1 - std::sqrt(dx * dx + dy * dy + dz * dz) * inverse_range;
    const float within = rest > 0 ? rest : 0;
    sum[i] += within * within;
  }
}

}  // namespace

PointEnergy::PointEnergy(std::span<const Vec3f> positions, float range)
    : x_(positions.size()),
      y_(positions.size()),
      z_(positions.size()),
      inverse_range_(1 / range),
      now_(positions.size(), 0),
      in_the_end_(positions.size(), 0) {
  for (std::size_t i = 0; i < positions.size(); ++i) x_[i] = positions[i].x(), y_[i] = positions[i].y(), z_[i] = positions[i].z();
}

void PointEnergy::add_to(std::vector<float>& energy, const float* position) const {
  add_kernel(x_, y_, z_, position, inverse_range_, energy.data());
}

}  // namespace curvecast
