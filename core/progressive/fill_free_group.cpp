#include "core/progressive/fill_free_group.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/base/reversed_bits.h"
#include "core/base/simd.h"
#include "core/progressive/candidate_points.h"

namespace curvecast {
namespace {

constexpr std::size_t kPlaces = 8;  // candidates in each child stratum
constexpr float kRange = 1.5f;      // lattice distances: a point farther from a candidate than this does not count

/// Candidates of a child stratum, in columns.
struct ChildPlaces {
  float x[kPlaces], y[kPlaces], z[kPlaces];     // relative to the curve's origin
  float nx[kPlaces], ny[kPlaces], nz[kPlaces];  // unit normals
  float nearest[kPlaces];                       // squared distance to the nearest point so far, up to the range
};

/// Spheres around the children's candidates, in columns.
struct ChildSpheres {
  float x[4 * kGroupStrata], y[4 * kGroupStrata], z[4 * kGroupStrata], radius[4 * kGroupStrata];
};

static_assert(kPlaces == sizeof(Float8) / sizeof(float));

/// Takes a point into account in all children of the first `count` that come within `range` of it: lowers `nearest` of the
/// candidates that face it.
CURVECAST_WIDE void take_point(const RankedPoint& point, float range, const ChildSpheres& spheres, std::size_t count,
                               ChildPlaces* children) {
  const float px = point.position[0], py = point.position[1], pz = point.position[2];
  const float nx = point.normal[0], ny = point.normal[1], nz = point.normal[2];
  for (std::size_t begin = 0; begin < count; begin += kPlaces) {
    Float8 x, y, z, radius;
    load_lanes(x, spheres.x + begin);
    load_lanes(y, spheres.y + begin);
    load_lanes(z, spheres.z + begin);
    load_lanes(radius, spheres.radius + begin);
    x -= px, y -= py, z -= pz, radius += range;
    const Int8 is_near = x * x + y * y + z * z <= radius * radius;
    std::int64_t any[kPlaces / 2];
    std::memcpy(any, &is_near, sizeof(any));
    if ((any[0] | any[1] | any[2] | any[3]) == 0) continue;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      if (is_near[i] == 0) continue;
      ChildPlaces& child = children[begin + i];
      Float8 cx, cy, cz, mx, my, mz, nearest;
      load_lanes(cx, child.x);
      load_lanes(cy, child.y);
      load_lanes(cz, child.z);
      load_lanes(mx, child.nx);
      load_lanes(my, child.ny);
      load_lanes(mz, child.nz);
      load_lanes(nearest, child.nearest);
      cx -= px, cy -= py, cz -= pz;
      const Float8 square = cx * cx + cy * cy + cz * cz, cosine = mx * nx + my * ny + mz * nz;
      const Int8 is_nearer = (square < nearest) & (cosine >= kSameSide);
      store_lanes(is_nearer ? square : nearest, child.nearest);
    }
  }
}

/// Returns the candidate of a child that is farthest from all points; 0 where all are the same.
std::size_t farthest_of(const ChildPlaces& child) {
  return static_cast<std::size_t>(std::max_element(child.nearest, child.nearest + kPlaces) - child.nearest);
}

class FreeGroup {
 public:
  FreeGroup(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed)
      : group_(group),
        range_(free_influence_radius(strata.total_area(), group.level)),
        at_(4 * group.size() * kPlaces),
        curve_position_(at_.size()),
        children_(4 * group.size()),
        has_point_(children_.size(), 0) {
    place_candidates(strata, group, seed, curve_position_, at_);
    for (std::size_t c = 0; c < children_.size(); ++c) measure(c);
  }

  /// Takes points around the group into account.
  void heed(std::span<const RankedPoint> around) {
    for (const RankedPoint& p : around) take(p);
  }

  void fill(std::span<const RankedPoint> base, std::span<RankedPoint> points) {
    for (const RankedPoint& p : base) {
      const std::size_t c = p.curve_position >> child_shift(group_.level) & (children_.size() - 1);
      points[c] = p;
      has_point_[c] = 1;
      take(p);
    }
    const std::uint64_t size = group_.size(), n = std::uint64_t{1} << 2 * group_.level, groups = n / size;
    const std::uint64_t turn = reversed_bits(group_.index, std::bit_width(groups) - 1);
    const int bits = std::bit_width(size) - 1;
    for (std::uint64_t round = 0; round < 3 * size; ++round) {
      const std::size_t c = next_child(reversed_bits(round % size, bits));
      const std::size_t i = c * kPlaces + farthest_of(children_[c]);
      points[c] = {at_[i], curve_position_[i], n + round * groups + turn};
      has_point_[c] = 1;
      take(points[c]);
    }
  }

 private:
  void measure(std::size_t c) {
    ChildPlaces& child = children_[c];
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const CurvePoint& p = at_[c * kPlaces + k];
      child.x[k] = p.position[0], child.y[k] = p.position[1], child.z[k] = p.position[2];
      child.nx[k] = p.normal[0], child.ny[k] = p.normal[1], child.nz[k] = p.normal[2];
      child.nearest[k] = range_ * range_;
      sum += Vec3f(child.x[k], child.y[k], child.z[k]);
    }
    const Vec3f centre = sum / kPlaces;
    float square = 0;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      square = std::max(square, (Vec3f(child.x[k], child.y[k], child.z[k]) - centre).squaredNorm());
    }
    spheres_.x[c] = centre.x(), spheres_.y[c] = centre.y(), spheres_.z[c] = centre.z();
    spheres_.radius[c] = std::sqrt(square);
  }

  void take(const RankedPoint& p) { take_point(p, range_, spheres_, children_.size(), children_.data()); }

  /// Returns the free child of a stratum with the widest gap.
  std::size_t next_child(std::uint64_t stratum) const {
    std::size_t best = 0;
    float widest = -1;
    for (std::size_t c = 4 * stratum; c < 4 * stratum + 4; ++c) {
      const float gap = children_[c].nearest[farthest_of(children_[c])];
      if (has_point_[c] == 0 && gap > widest) best = c, widest = gap;
    }
    return best;
  }

  const StratumGroup group_;
  const float range_;
  std::vector<CurvePoint> at_;                 // kPlaces for each child
  std::vector<std::uint64_t> curve_position_;  // of each
  std::vector<ChildPlaces> children_;
  std::vector<std::uint8_t> has_point_;  // of each child
  ChildSpheres spheres_;
};

}  // namespace

float free_influence_radius(double total_area, int level) {
  return kRange * lattice_distance(total_area, std::ldexp(1.0, 2 * level));
}

void fill_free_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                     std::span<RankedPoint> points) {
  FreeGroup free(strata, group, seed);
  free.heed(done);
  free.heed(open);
  free.fill(base, points);
}

}  // namespace curvecast
