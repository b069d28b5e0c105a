#include "core/progressive/fill_free_group.h"

#include <algorithm>
#include <array>
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

constexpr std::size_t kLanes = sizeof(Float8) / sizeof(float);
constexpr std::size_t kFree = 3;  // children of a stratum that have no point yet
constexpr std::size_t kMaxChildren = kFree * kGroupStrata, kBlocks = kMaxChildren / kLanes;

static_assert(kPlaces == kLanes && kMaxChildren % kLanes == 0 && kBlocks % kLanes == 0);

/// Candidates of a child stratum, in columns.
struct ChildPlaces {
  float x[kPlaces], y[kPlaces], z[kPlaces];     // relative to the curve's origin
  float nx[kPlaces], ny[kPlaces], nz[kPlaces];  // unit normals
  float nearest[kPlaces];                       // squared distance to the nearest point so far, up to the range
};

constexpr float kNowhere = 1e18f;  // of a coordinate: near nothing, and its square is finite
constexpr float kSlack = 1.001f;   // of radii, for rounding

/// Spheres, in columns.
template <std::size_t n>
struct Spheres {
  float x[n], y[n], z[n], radius[n];

  Spheres() {
    for (std::size_t i = 0; i < n; ++i) remove(i);
  }
  void remove(std::size_t i) { x[i] = y[i] = z[i] = kNowhere, radius[i] = 0; }
  bool has(std::size_t i) const { return x[i] != kNowhere; }
  Vec3f centre(std::size_t i) const { return {x[i], y[i], z[i]}; }
  /// Centres sphere i on the mean of some places. Its radius reaches the farthest of them.
  void set_around(std::size_t i, std::span<const Vec3f> places) {
    Vec3f sum = Vec3f::Zero();
    for (const Vec3f& place : places) sum += place;
    const Vec3f mean = sum / static_cast<float>(places.size());
    float square = 0;
    for (const Vec3f& place : places) square = std::max(square, (place - mean).squaredNorm());
    x[i] = mean.x(), y[i] = mean.y(), z[i] = mean.z();
    radius[i] = kSlack * std::sqrt(square);
  }
};

/// Calls visit(i) for each of the kLanes spheres from `begin` on that a place lies in.
template <std::size_t n, typename Visit>
[[gnu::always_inline]] inline void visit_around(const Spheres<n>& spheres, std::size_t begin, const float* place,
                                                const Visit& visit) {
  Float8 x, y, z, radius;
  load_lanes(x, spheres.x + begin);
  load_lanes(y, spheres.y + begin);
  load_lanes(z, spheres.z + begin);
  load_lanes(radius, spheres.radius + begin);
  x -= place[0], y -= place[1], z -= place[2];
  const Int8 is_in = x * x + y * y + z * z <= radius * radius;
  std::int64_t any[kLanes / 2];
  std::memcpy(any, &is_in, sizeof(any));
  if ((any[0] | any[1] | any[2] | any[3]) == 0) return;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (is_in[i] != 0) visit(begin + i);
  }
}

/// The children of a group that have no point yet, three to a stratum, in curve order.
class FreeChildren {
 public:
  /// `at`: kPlaces candidates for each child. `range`: how far a point counts.
  FreeChildren(std::span<const CurvePoint> at, float range) : places_(at.size() / kPlaces) {
    std::array<Vec3f, kPlaces> positions;
    for (std::size_t c = 0; c < places_.size(); ++c) {
      ChildPlaces& child = places_[c];
      for (std::size_t k = 0; k < kPlaces; ++k) {
        const CurvePoint& p = at[c * kPlaces + k];
        positions[k] = Vec3f(p.position[0], p.position[1], p.position[2]);
        child.x[k] = p.position[0], child.y[k] = p.position[1], child.z[k] = p.position[2];
        child.nx[k] = p.normal[0], child.ny[k] = p.normal[1], child.nz[k] = p.normal[2];
        child.nearest[k] = range * range;
      }
      spheres_.set_around(c, positions);
      extent_[c] = spheres_.radius[c];
    }
    tighten();
  }

  /// Returns the candidate of a child that is farthest from all points; the first of them where several are.
  std::size_t farthest(std::size_t c) const {
    const float* const nearest = places_[c].nearest;
    return static_cast<std::size_t>(std::max_element(nearest, nearest + kPlaces) - nearest);
  }
  /// Returns how far that is, squared; less than 0 where the child has a point.
  float gap(std::size_t c) const { return spheres_.has(c) ? places_[c].nearest[farthest(c)] : -1; }
  /// Says that the child has a point.
  void close(std::size_t c) { spheres_.remove(c); }

  /// Takes a point into account: lowers the distances of the candidates that face it. A function, not the loop over points, is
  /// compiled for wider vectors.
  CURVECAST_WIDE void take(const RankedPoint& point) {
    for (std::size_t b = 0; b < kBlocks; b += kLanes) {
      visit_around(
          blocks_, b, point.position, [&](std::size_t block) __attribute__((always_inline)) {
            visit_around(
                spheres_, block * kLanes,
                point.position, [&](std::size_t c) __attribute__((always_inline)) { lower(places_[c], point); });
          });
    }
  }

  /// Forgets about points that can be nearer to nothing any more: fewer have to be looked at.
  void tighten() {
    std::vector<Vec3f> centres;
    for (std::size_t begin = 0; begin < places_.size(); begin += kLanes) {
      const std::size_t block = begin / kLanes;
      float most = 0;
      centres.clear();
      for (std::size_t c = begin; c < std::min(begin + kLanes, places_.size()); ++c) {
        if (!spheres_.has(c)) continue;
        centres.push_back(spheres_.centre(c));
        spheres_.radius[c] = extent_[c] + kSlack * std::sqrt(gap(c));
        most = std::max(most, spheres_.radius[c]);
      }
      blocks_.remove(block);
      if (centres.empty()) continue;
      blocks_.set_around(block, centres);
      blocks_.radius[block] += kSlack * most;
    }
  }

 private:
  [[gnu::always_inline]] static void lower(ChildPlaces& child, const RankedPoint& point) {
    Float8 x, y, z, nx, ny, nz, nearest;
    load_lanes(x, child.x);
    load_lanes(y, child.y);
    load_lanes(z, child.z);
    load_lanes(nx, child.nx);
    load_lanes(ny, child.ny);
    load_lanes(nz, child.nz);
    load_lanes(nearest, child.nearest);
    x -= point.position[0], y -= point.position[1], z -= point.position[2];
    const Float8 square = x * x + y * y + z * z;
    const Float8 cosine = nx * point.normal[0] + ny * point.normal[1] + nz * point.normal[2];
    const Int8 is_nearer = (square < nearest) & (cosine >= kSameSide);
    store_lanes(is_nearer ? square : nearest, child.nearest);
  }

  std::vector<ChildPlaces> places_;
  float extent_[kMaxChildren];     // radius of a sphere around a child's candidates
  Spheres<kMaxChildren> spheres_;  // around what is nearer to a child's candidates than all points; none, once it has a point
  Spheres<kBlocks> blocks_;        // around kLanes spheres
};

/// The number of the child stratum that a point of a group lies in.
std::uint32_t child_of(const StratumGroup& group, const RankedPoint& p) {
  return static_cast<std::uint32_t>(p.curve_position >> child_shift(group.level) & (4 * group.size() - 1));
}

/// Numbers of the children that have no point, in curve order. `base`: the group's points, one in each stratum.
std::vector<std::uint32_t> free_children(const StratumGroup& group, std::span<const RankedPoint> base) {
  std::vector<std::uint32_t> free;
  for (std::uint32_t c = 0; c < 4 * group.size(); ++c) {
    if (c != child_of(group, base[c / 4])) free.push_back(c);
  }
  return free;
}

/// Moves the points of a group that lie about at their curve positions onto the surface.
void place_on_surface(const CurveStrata& strata, int level, std::span<RankedPoint> points) {
  std::vector<std::size_t> which;
  std::vector<double> t;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].face != kNone) continue;
    which.push_back(i);
    t.push_back(unit_curve_position(points[i].curve_position));
  }
  std::vector<CurvePoint> at(t.size());
  // Free groups do not see all of their neighbours, which may have a point at the same vertex.
  strata.points_at(t, grain_of_candidates(level), at, PointPlaces::kOnSurface);
  for (std::size_t k = 0; k < which.size(); ++k) static_cast<CurvePoint&>(points[which[k]]) = at[k];
}

}  // namespace

float free_influence_radius(double total_area, int level) {
  return kRange * lattice_distance(total_area, std::ldexp(1.0, 2 * level));
}

void fill_free_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                     std::span<RankedPoint> points) {
  const std::vector<std::uint32_t> number = free_children(group, base);
  std::vector<CurvePoint> at(number.size() * kPlaces);
  std::vector<std::uint64_t> curve_position(at.size());
  place_candidates(strata, group, seed, number, curve_position, at);
  FreeChildren children(at, free_influence_radius(strata.total_area(), group.level));
  for (const RankedPoint& p : base) {
    points[child_of(group, p)] = p;
    children.take(p);
  }
  children.tighten();
  for (const std::span<const RankedPoint> around : {done, open}) {
    for (const RankedPoint& p : around) children.take(p);
  }
  const std::uint64_t size = group.size(), n = std::uint64_t{1} << 2 * group.level, groups = n / size;
  const std::uint64_t turn = reversed_bits(group.index, std::bit_width(groups) - 1);
  const int bits = std::bit_width(size) - 1;
  for (std::uint64_t round = 0; round < kFree * size; ++round) {
    if (round % size == 0) children.tighten();
    std::size_t c = kFree * reversed_bits(round % size, bits);
    for (std::size_t other = c + 1, end = c + kFree; other < end; ++other) {
      if (children.gap(other) > children.gap(c)) c = other;
    }
    const std::size_t i = c * kPlaces + children.farthest(c);
    RankedPoint& point = points[number[c]] = {at[i], curve_position[i], n + round * groups + turn};
    children.close(c);
    children.take(point);
  }
  place_on_surface(strata, group.level, points);
}

}  // namespace curvecast
