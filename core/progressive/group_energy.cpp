#include "core/progressive/group_energy.h"

#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// README.md says where these come from. In lattice distances of the points of lower levels.
constexpr float kRange = 3;          // up to this distance points put energy on a candidate
constexpr float kNearRange = 0.75f;  // children within this distance count one by one
constexpr std::size_t kPlaces = 4;   // candidates that stand for a child's area
constexpr std::size_t kStep = kCandidates / kPlaces;

/// Adds Askey's function (1 - r)^2, see point_energy.cpp, of the distances r in ranges between the candidates and p.
CURVECAST_WIDE void add_energy(const CandidatePoints& candidates, const float* p, float inverse_range, float weight, float* sum) {
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float x = candidates.x[k] - p[0], y = candidates.y[k] - p[1], z = candidates.z[k] - p[2];
    const float rest = 1 - std::sqrt(x * x + y * y + z * z) * inverse_range;
    const float within = rest > 0 ? rest : 0;
    sum[k] += weight * within * within;
  }
}

/// Adds the slope of the same function at a position, for a point at p.
[[gnu::always_inline]] inline void add_slope(const Vec3f& position, const float* p, float inverse_range, float weight,
                                             Vec3f& slope) {
  const Vec3f from = position - Vec3f(p[0], p[1], p[2]);
  const float distance = from.norm(), rest = 1 - distance * inverse_range;
  if (rest > 0 && distance > 0) slope -= weight * 2 * rest * inverse_range / distance * from;
}

/// Adds the energy that falls by a slope from the middle of the candidates.
CURVECAST_WIDE void add_plane(const CandidatePoints& candidates, const Vec3f& middle, const Vec3f& slope, float* sum) {
  const float mx = middle.x(), my = middle.y(), mz = middle.z(), sx = slope.x(), sy = slope.y(), sz = slope.z();
  for (std::size_t k = 0; k < kCandidates; ++k) {
    sum[k] += (candidates.x[k] - mx) * sx + (candidates.y[k] - my) * sy + (candidates.z[k] - mz) * sz;
  }
}

}  // namespace

GroupEnergy::GroupEnergy(const GroupCandidates& candidates, std::span<const std::uint8_t> moves)
    : candidates_(candidates), around_(candidates.size()) {
  const float lattice = lattice_distance(candidates.total_area(), std::ldexp(1.0, 2 * candidates.group().level));
  inverse_range_ = 1 / (kRange * lattice);
  const float near = kNearRange * lattice, reach = kRange * lattice + near;
  for (std::size_t c = 0; c < around_.size(); ++c) {
    if (moves[c] == 0) continue;
    const Vec3f& middle = candidates.child(c).centre;
    Around& around = around_[c];
    around.expected.fill(0);
    Vec3f slope = Vec3f::Zero();
    for (std::uint32_t j = 0; j < around_.size(); ++j) {
      const float square = (candidates.child(j).centre - middle).squaredNorm();
      if (square > reach * reach) continue;
      const bool is_near = square <= near * near;
      if (j != c) (is_near ? around.near : around.far).push_back(j);
      if (!is_near) {
        add_slope(middle, candidates.child(j).centre.data(), inverse_range_, 1, slope);
        continue;
      }
      const CandidatePoints& places = candidates.in_child(j);
      for (std::size_t k = kStep / 2; k < kCandidates; k += kStep) {
        const float place[] = {places.x[k], places.y[k], places.z[k]};
        add_energy(candidates.in_child(c), place, inverse_range_, 1.0f / kPlaces, around.expected.data());
      }
    }
    add_plane(candidates.in_child(c), middle, slope, around.expected.data());
  }
}

GroupEnergy::Row GroupEnergy::of_candidates(std::size_t c, std::span<const RankedPoint> points) const {
  const Around& around = around_[c];
  const CandidatePoints& own = candidates_.in_child(c);
  const Vec3f& middle = candidates_.child(c).centre;
  Row energy;
  for (std::size_t k = 0; k < kCandidates; ++k) energy[k] = -around.expected[k];
  for (const std::uint32_t j : around.near) add_energy(own, points[j].position, inverse_range_, 1, energy.data());
  Vec3f slope = Vec3f::Zero();
  for (const std::uint32_t j : around.far) add_slope(middle, points[j].position, inverse_range_, 1, slope);
  add_plane(own, middle, slope, energy.data());
  return energy;
}

}  // namespace curvecast
