#include "core/sample/rank_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/lanes.h"
#include "core/sample/random.h"
#include "core/sample/reversed_bits.h"

namespace curvecast {
namespace {

constexpr std::size_t kPlaces = 64;        // that are tried for each point
constexpr std::uint64_t kGroupStrata = 4;  // among which one lets others go first where it has no room
constexpr float kReach = 1.1f;             // in lattice distances: no point is felt beyond
// Relative radius: with this much a stratum takes its turn; this much, or most of what it could have, will do for a point, which
// then lies as near the middle of its stratum as it can.
constexpr float kRoom = 0.5f, kEnough = 0.64f, kMost = 0.85f;
// Once all points of a block are there, each moves so again, kCentralSweeps times; then those below kEnough go where they have
// most, kSweeps times, and those below kPoor look for places for themselves and a neighbour within kAround at once.
constexpr float kPoor = 0.54f, kAround = 0.8f;
constexpr int kCentralSweeps = 2, kSweeps = 1, kPairSweeps = 3;
constexpr float kFar = std::numeric_limits<float>::max();
constexpr float kSameSide = -0.5f;  // normals that differ by more than 120 degrees are on the two sides of something thin

/// The distance of neighbours in a hexagonal lattice of n points.
float lattice_distance(double area, double n) { return static_cast<float>(std::sqrt(2 * area / (std::numbers::sqrt3 * n))); }

/// Places in a child stratum, and how near points come to them.
struct Places {
  float x[kPlaces], y[kPlaces], z[kPlaces];
  float nx[kPlaces], ny[kPlaces], nz[kPlaces];
  float away[kPlaces];    // square distance from the center
  float before[kPlaces];  // square distance of the nearest point of a lower rank
  float after[kPlaces];   // of points of higher ranks: the least square distance times the number of points then
};

/// A stratum of the next level.
struct Child {
  Vec3f center, normal;
  float radius;               // of the places about the center
  float all_face, none_face;  // of the normal's cosine with another: from here on all places face it, below here none
  bool full = false;
};

/// A point's square distance from each place, times `weight`, goes into `least` where it is less.
CURVECAST_WIDE void take_nearer(const Places& places, const RankedPoint& p, float weight, float* least) {
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const float x = places.x[k] - p.position[0], y = places.y[k] - p.position[1], z = places.z[k] - p.position[2];
    const float d = (x * x + y * y + z * z) * weight;
    least[k] = d < least[k] ? d : least[k];
  }
}

/// The same for the places that face the point.
CURVECAST_WIDE void take_nearer_facing(const Places& places, const RankedPoint& p, float weight, float* least) {
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const float x = places.x[k] - p.position[0], y = places.y[k] - p.position[1], z = places.z[k] - p.position[2];
    const float cosine = places.nx[k] * p.normal[0] + places.ny[k] * p.normal[1] + places.nz[k] * p.normal[2];
    const float square = (x * x + y * y + z * z) * weight;
    const float d = cosine >= kSameSide ? square : kFar;
    least[k] = d < least[k] ? d : least[k];
  }
}

struct Best {
  float value = -1;
  std::size_t place = 0;
};

/// The place with the largest of min(before n, after).
CURVECAST_WIDE Best best_place(const float* before, const float* after, float n) {
  float value[kPlaces];
  float most = -1;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const float b = before[k] * n;
    value[k] = b < after[k] ? b : after[k];
    most = value[k] > most ? value[k] : most;
  }
  Best best{most, 0};
  while (value[best.place] != most) ++best.place;
  return best;
}

/// Of the places where that is large enough, the one nearest to the center.
CURVECAST_WIDE std::size_t central_place(const Places& places, const float* after, float n, float enough) {
  float away[kPlaces];
  float least = kFar;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const float b = places.before[k] * n;
    const float value = b < after[k] ? b : after[k];
    away[k] = value >= enough ? places.away[k] : kFar;
    least = away[k] < least ? away[k] : least;
  }
  std::size_t place = 0;
  while (away[place] != least) ++place;
  return place;
}

/// Points in columns, to be searched from end to end.
struct PointColumns {
  std::vector<float> x, y, z;
  std::vector<float> root;    // of the number of points there are when it is the last
  std::vector<float> radius;  // how far it may move

  explicit PointColumns(std::size_t n) : x(n), y(n), z(n), root(n), radius(n) {}
};

/// Which points come as near as `reach` over the root of their number to a place that is `radius` about p at most.
CURVECAST_WIDE void mark_near(const PointColumns& points, const Vec3f& p, float radius, float own_root, float reach,
                              std::int32_t* is_near) {
  const float px = p.x(), py = p.y(), pz = p.z();
  const std::size_t n = points.x.size();
  const float *xs = points.x.data(), *ys = points.y.data(), *zs = points.z.data(), *roots = points.root.data(),
              *radii = points.radius.data();
  for (std::size_t i = 0; i < n; ++i) {
    const float x = xs[i] - px, y = ys[i] - py, z = zs[i] - pz;
    const float root = roots[i] > own_root ? roots[i] : own_root;
    const float most = reach + (radii[i] + radius) * root;
    is_near[i] = (x * x + y * y + z * z) * root * root < most * most;
  }
}

class BlockFiller {
 public:
  BlockFiller(const CurveStrata& strata, const RankBlock& block, std::uint64_t seed, std::span<RankedPoint> points)
      : block_(block),
        size_(block.size()),
        n_(std::uint64_t{1} << 2 * block.level),
        area_(strata.total_area()),
        points_(points),
        at_(points.size() * kPlaces),
        coordinate_(at_.size()),
        places_(points.size()),
        children_(points.size()),
        curve_(strata.curve()) {
    find_places(strata, seed);
    for (std::size_t c = 0; c < points.size(); ++c) measure(c);
  }

  void fill(std::span<const RankedPoint> base, std::span<const RankedPoint> near) {
    for (const RankedPoint& p : base) {
      const std::size_t c = p.coordinate >> child_shift() & (points_.size() - 1);
      points_[c] = p;
      children_[c].full = true;
    }
    const float reach = rank_reach(area_, block_.level);
    for (const RankedPoint& p : base) take(p, reach);
    for (const RankedPoint& p : near) take(p, reach);
    take_turns();
    relax(near);
  }

 private:
  int child_shift() const { return 62 - 2 * block_.level; }  // bits of a coordinate within a child stratum

  void find_places(const CurveStrata& strata, std::uint64_t seed) {
    std::vector<double> t(at_.size());
    const std::uint64_t step = (std::uint64_t{1} << child_shift()) / kPlaces;
    for (std::size_t c = 0; c < points_.size(); ++c) {
      const std::uint64_t stratum = block_.index * points_.size() + c;
      const double offset = random_unit(seed + static_cast<std::uint64_t>(block_.level), stratum);
      std::uint64_t place = (stratum << child_shift()) + static_cast<std::uint64_t>(offset * static_cast<double>(step));
      for (std::size_t i = c * kPlaces; i < (c + 1) * kPlaces; ++i, place += step) {
        coordinate_[i] = place;
        t[i] = curve_coordinate(place);
      }
    }
    strata.places_at(t, at_);
  }

  void measure(std::size_t c) {
    Places& places = places_[c];
    Child& child = children_[c];
    Vec3f sum = Vec3f::Zero(), normals = Vec3f::Zero();
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const CurvePlace& place = at_[c * kPlaces + k];
      const Vec3f normal = curve_.normal(place.vertex);
      places.x[k] = place.position[0], places.y[k] = place.position[1], places.z[k] = place.position[2];
      places.nx[k] = normal.x(), places.ny[k] = normal.y(), places.nz[k] = normal.z();
      places.before[k] = rank_reach(area_, block_.level) * rank_reach(area_, block_.level);
      places.after[k] = kFar;
      sum += Vec3f(place.position[0], place.position[1], place.position[2]);
      normals += normal;
    }
    child.center = sum / kPlaces;
    child.normal = normals.normalized();
    float square = 0, cosine = 1;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      places.away[k] = (Vec3f(places.x[k], places.y[k], places.z[k]) - child.center).squaredNorm();
      square = std::max(square, places.away[k]);
      cosine = std::min(cosine, Vec3f(places.nx[k], places.ny[k], places.nz[k]).dot(child.normal));
    }
    child.radius = std::sqrt(square);
    // Cosines of 120 degrees less and more half the angle of the normals' cone, with a little slack.
    constexpr float kSlack = 1e-3f;
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine)), half_turn = 0.5f * std::numbers::sqrt3_v<float>;
    child.all_face = cosine > 0.5f ? kSameSide * cosine + half_turn * sine + kSlack : 2;
    child.none_face = cosine > 0.5f ? kSameSide * cosine - half_turn * sine - kSlack : -2;
  }

  void take_nearer_of(std::size_t c, const RankedPoint& p, float weight, float* least) const {
    const Child& child = children_[c];
    const float cosine = child.normal.dot(Vec3f(p.normal[0], p.normal[1], p.normal[2]));
    if (cosine >= child.all_face) {
      take_nearer(places_[c], p, weight, least);
    } else if (cosine >= child.none_face) {
      take_nearer_facing(places_[c], p, weight, least);
    }
  }

  /// All children that have no point yet are told of a point.
  void take(const RankedPoint& p, float reach, bool is_new = false) {
    const Vec3f position(p.position[0], p.position[1], p.position[2]);
    const bool comes_later = !is_new && p.rank >= n_;
    for (std::size_t c = 0; c < children_.size(); ++c) {
      const Child& child = children_[c];
      const float most = reach + child.radius;
      if (child.full || (position - child.center).squaredNorm() > most * most) continue;
      take_nearer_of(c, p, comes_later ? static_cast<float>(p.rank + 1) : 1, comes_later ? places_[c].after : places_[c].before);
    }
  }

  void put(std::size_t c, std::size_t place, std::uint32_t rank) {
    const CurvePlace& at = at_[c * kPlaces + place];
    const Places& places = places_[c];
    points_[c] = {coordinate_[c * kPlaces + place],
                  {at.position[0], at.position[1], at.position[2]},
                  {places.nx[place], places.ny[place], places.nz[place]},
                  at.vertex,
                  rank};
  }

  void take_turns() {
    const std::uint64_t group = std::min(size_, kGroupStrata), groups = size_ / group, all_groups = n_ / group;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> turns;
    for (std::uint64_t g = 0; g < groups; ++g) {
      turns.emplace_back(reversed_bits(block_.index * groups + g, std::bit_width(all_groups) - 1), g);
    }
    std::sort(turns.begin(), turns.end());
    std::vector<std::uint8_t> held(size_, 1);  // points in each stratum
    for (std::uint64_t round = 0; round < 3 * group; ++round) {
      for (const auto& [turn, g] : turns) {
        const std::uint64_t rank = n_ + round * all_groups + turn;
        const auto count = static_cast<float>(rank + 1);
        Best best;
        std::size_t chosen = 0;
        for (std::uint64_t i = 0; i < group && best.value < kRoom * kRoom * unit(); ++i) {
          const std::uint64_t s = g * group + reversed_bits((round + i) % group, std::bit_width(group) - 1);
          if (held[s] > 1 + round / group) continue;
          for (std::size_t c = 4 * s; c < 4 * s + 4; ++c) {
            if (children_[c].full) continue;
            const Best here = best_place(places_[c].before, places_[c].after, count);
            if (here.value > best.value) best = here, chosen = c;
          }
        }
        put(chosen, central_place(places_[chosen], places_[chosen].after, count, enough(best)), static_cast<std::uint32_t>(rank));
        children_[chosen].full = true;
        ++held[chosen / 4];
        take(points_[chosen], kReach * lattice_distance(area_, static_cast<double>(count)), true);
      }
    }
  }

  /// Points that have others near move within their strata, to where those are farthest.
  void relax(std::span<const RankedPoint> near) {
    near_ = near;
    find_neighbours();
    std::vector<std::pair<std::uint32_t, std::size_t>> by_rank;
    for (std::size_t c = 0; c < points_.size(); ++c) {
      if (points_[c].rank >= n_) by_rank.emplace_back(points_[c].rank, c);
    }
    std::sort(by_rank.begin(), by_rank.end());
    for (int sweep = 0; sweep < kCentralSweeps + kSweeps; ++sweep) {
      for (std::size_t i = 0; i < by_rank.size(); ++i) {
        const std::size_t c = (sweep % 2 ? by_rank[i] : by_rank[by_rank.size() - 1 - i]).second;
        if (sweep < kCentralSweeps) {
          const Best best = farthest_place(c, kNobody);
          move(c, central_place(places_[c], places_[c].before, 1, enough(best)));
        } else if (spacing_of(c) < kEnough) {
          move(c, farthest_place(c, kNobody).place);
        }
      }
    }
    for (int sweep = 0; sweep < kPairSweeps; ++sweep) {
      for (const auto& [rank, c] : by_rank) {
        if (spacing_of(c) < kPoor) move_with_neighbour(c);
      }
    }
  }

  /// Moves a point and one that is near at once, if that does more good than harm.
  void move_with_neighbour(std::size_t c) {
    const RankedPoint before = points_[c];
    Best most{spacing_of(c), 0};
    std::size_t best_neighbour = kNobody, best_place_there = 0;
    for (const std::uint32_t j : neighbours_of(c)) {
      if (j >= points_.size() || points_[j].rank < n_) continue;
      const RankedPoint before_there = points_[j];
      const Best here = farthest_place(c, j);
      move(c, here.place);
      const Best there = farthest_place(j, kNobody);
      move(j, there.place);
      const float value = std::min(spacing_of(c), spacing_of(j));
      if (value > most.value) most = {value, here.place}, best_neighbour = j, best_place_there = there.place;
      points_[j] = before_there;
      points_[c] = before;
    }
    if (best_neighbour == kNobody) return;
    move(c, most.place);
    move(best_neighbour, best_place_there);
  }

  float enough(const Best& best) const { return std::min(kEnough * kEnough * unit(), kMost * best.value); }

  static constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();

  const RankedPoint& point(std::size_t i) const { return i < points_.size() ? points_[i] : near_[i - points_.size()]; }
  float unit() const { return lattice_distance(area_, 1) * lattice_distance(area_, 1); }

  void find_neighbours() {
    PointColumns columns(points_.size() + near_.size());
    for (std::size_t i = 0; i < columns.x.size(); ++i) {
      const RankedPoint& p = point(i);
      const bool moves = i < points_.size() && p.rank >= n_;
      const Vec3f at = moves ? children_[i].center : Vec3f(p.position[0], p.position[1], p.position[2]);
      columns.x[i] = at.x(), columns.y[i] = at.y(), columns.z[i] = at.z();
      columns.root[i] = std::sqrt(static_cast<float>(p.rank + 1));
      columns.radius[i] = moves ? children_[i].radius : 0;
    }
    std::vector<std::int32_t> is_near(columns.x.size());
    const float reach = kAround * lattice_distance(area_, 1);
    first_neighbour_.assign(points_.size() + 1, 0);
    for (std::size_t c = 0; c < points_.size(); ++c) {
      if (points_[c].rank >= n_) {
        mark_near(columns, children_[c].center, children_[c].radius, columns.root[c], reach, is_near.data());
        is_near[c] = 0;
        for (std::size_t i = 0; i < is_near.size(); ++i) {
          if (is_near[i]) neighbours_.push_back(static_cast<std::uint32_t>(i));
        }
      }
      first_neighbour_[c + 1] = neighbours_.size();
    }
  }
  std::span<const std::uint32_t> neighbours_of(std::size_t c) const {
    return std::span(neighbours_).subspan(first_neighbour_[c], first_neighbour_[c + 1] - first_neighbour_[c]);
  }

  /// A point's relative radius, when it comes and ever after.
  float spacing_of(std::size_t c) const {
    const RankedPoint& p = points_[c];
    float least = kFar;
    for (const std::uint32_t j : neighbours_of(c)) {
      const RankedPoint& q = point(j);
      const float x = p.position[0] - q.position[0], y = p.position[1] - q.position[1], z = p.position[2] - q.position[2];
      const float cosine = p.normal[0] * q.normal[0] + p.normal[1] * q.normal[1] + p.normal[2] * q.normal[2];
      const float d = (x * x + y * y + z * z) * static_cast<float>(std::max(p.rank, q.rank) + 1);
      if (d < least && cosine >= kSameSide) least = d;
    }
    return std::sqrt(least / unit());
  }

  /// Where in its stratum a point would be farthest from all others but one.
  Best farthest_place(std::size_t c, std::size_t but) {
    float* least = places_[c].before;
    std::fill_n(least, kPlaces, kFar);
    for (const std::uint32_t j : neighbours_of(c)) {
      const RankedPoint& p = point(j);
      if (j != but) take_nearer_of(c, p, static_cast<float>(std::max(p.rank, points_[c].rank) + 1), least);
    }
    return best_place(least, least, 1);
  }

  void move(std::size_t c, std::size_t place) { put(c, place, points_[c].rank); }

  RankBlock block_;
  std::uint64_t size_, n_;  // strata of the block and of the level
  double area_;
  std::span<RankedPoint> points_;
  std::vector<CurvePlace> at_;             // kPlaces in each child
  std::vector<std::uint64_t> coordinate_;  // of each
  std::vector<Places> places_;             // of each child
  std::vector<Child> children_;
  const SurfaceCurve& curve_;
  std::span<const RankedPoint> near_;
  std::vector<std::uint32_t> neighbours_;  // of all children, one after the other
  std::vector<std::size_t> first_neighbour_;
};

}  // namespace

float rank_reach(double total_area, int level) { return lattice_distance(total_area, std::ldexp(1.0, 2 * level)); }

void fill_rank_block(const CurveStrata& strata, const RankBlock& block, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> near, std::uint64_t seed, std::span<RankedPoint> points) {
  BlockFiller(strata, block, seed, points).fill(base, near);
}

}  // namespace curvecast
