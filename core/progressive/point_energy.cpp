#include "core/progressive/crowding.h"

#include <cmath>

#include "core/base/lanes.h"

namespace curvecast {
namespace {

/// Askey's function (1 - r)^2 of the distance r: like the distance itself, its spectrum falls with the third power of the
/// frequency, and it ends.
CURVECAST_WIDE void add_nearness(std::span<const float> x, std::span<const float> y, std::span<const float> z, const float* p,
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

Crowding::Crowding(std::span<const Vec3f> places, float range)
    : x_(places.size()),
      y_(places.size()),
      z_(places.size()),
      inverse_range_(1 / range),
      now_(places.size(), 0),
      in_the_end_(places.size(), 0) {
  for (std::size_t i = 0; i < places.size(); ++i) x_[i] = places[i].x(), y_[i] = places[i].y(), z_[i] = places[i].z();
}

void Crowding::add_to(std::vector<float>& felt, const float* position) const {
  add_nearness(x_, y_, z_, position, inverse_range_, felt.data());
}

}  // namespace curvecast
