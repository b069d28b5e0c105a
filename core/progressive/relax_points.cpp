#include "core/progressive/relax_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/simd.h"
#include "core/progressive/group_energy.h"

namespace curvecast {
namespace {

// README.md says where these come from. First each point moves to the most central candidate that is far enough from others,
// kCentralSweeps times. Then the points below kTargetRelativeRadius go where they are farthest from others. Then those below
// kPoorRelativeRadius try to move together with one neighbour, kPairSweeps times. Then each point moves to the candidate with the
// least energy that is as far from others as it was, or kPoorRelativeRadius, kEvenSweeps times; and the poor ones once more as
// before.
constexpr float kPoorRelativeRadius = 0.62f;
constexpr float kMostAside = 0.7f;       // part of a child's radius: for evenness no point goes farther from its middle
constexpr float kNeighbourRange = 0.8f;  // lattice distances: points that may come nearer to each other are neighbours
constexpr int kCentralSweeps = 2, kPairSweeps = 3, kEvenSweeps = 2;
// Points of a group have some 30 neighbours on average. Where a surface is crumpled up they have thousands, nothing comes apart,
// and work would grow with the square of their number, for pairs with the cube: with more than these there are no pairs, no
// moves.
constexpr std::size_t kPairCrowd = 72, kCrowd = 192;

/// Points in columns, to be searched from end to end.
struct PointColumns {
  std::vector<float> x, y, z;
  std::vector<float> root;    // square root of the number of points there are when the point comes
  std::vector<float> radius;  // how far the point may move

  explicit PointColumns(std::size_t n) : x(n), y(n), z(n), root(n), radius(n) {}
};

/// Marks the points that may come as near as `reach` over the root of the number of points to a position within `radius` of p.
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

class Relaxation {
 public:
  Relaxation(GroupCandidates& candidates, std::span<const RankedPoint> near, std::span<RankedPoint> points)
      : candidates_(candidates),
        points_(points),
        near_(near),
        n_(std::uint64_t{1} << 2 * candidates.group().level),
        unit_(lattice_distance(candidates.total_area(), 1)) {
    find_neighbours();
  }

  void run() {
    if (is_crowded(kCrowd)) return;
    ByRank by_rank;
    for (std::size_t c = 0; c < points_.size(); ++c) {
      if (points_[c].rank >= n_) by_rank.emplace_back(points_[c].rank, c);
    }
    std::sort(by_rank.begin(), by_rank.end());
    for (int sweep = 0; sweep < kCentralSweeps; ++sweep) {
      for (std::size_t i = 0; i < by_rank.size(); ++i) {
        const std::size_t c = (sweep % 2 ? by_rank[i] : by_rank[by_rank.size() - 1 - i]).second;
        const BestCandidate best = farthest_candidate(c, kNobody);
        move(c, central_candidate(candidates_.in_child(c), candidates_.in_child(c).nearest_lower, 1, enough(best)));
      }
    }
    keep_apart(by_rank, kTargetRelativeRadius);
    std::vector<std::uint8_t> moves(points_.size());
    for (const auto& [rank, c] : by_rank) moves[c] = 1;
    const GroupEnergy energy(candidates_, moves);
    for (int sweep = 0; sweep < kEvenSweeps; ++sweep) {
      for (std::size_t c = 0; c < points_.size(); ++c) {
        if (moves[c] != 0) move_to_least(energy, c);
      }
    }
    keep_apart(by_rank, kPoorRelativeRadius);
  }

 private:
  static constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
  using ByRank = std::vector<std::pair<std::uint64_t, std::size_t>>;

  /// Moves points below a relative radius away from others, the highest ranks first, then the poor ones in pairs.
  void keep_apart(const ByRank& by_rank, float relative_radius) {
    for (auto at = by_rank.rbegin(); at != by_rank.rend(); ++at) {
      if (spacing_of(at->second) < relative_radius) move(at->second, farthest_candidate(at->second, kNobody).index);
    }
    for (int sweep = 0; sweep < kPairSweeps && !is_crowded(kPairCrowd); ++sweep) {
      for (const auto& [rank, c] : by_rank) {
        if (spacing_of(c) < kPoorRelativeRadius) move_with_neighbour(c);
      }
    }
  }

  /// Moves a point to the candidate with the least energy, not far from the middle of its child: the points of groups to come
  /// need room beside it.
  void move_to_least(const GroupEnergy& energy, std::size_t c) {
    constexpr float kSame = 0.999f;  // of a squared distance: rounding takes no candidate away
    const float now = spacing_of(c), enough = std::min(kPoorRelativeRadius * kPoorRelativeRadius, kSame * now * now) * unit();
    farthest_candidate(c, kNobody);
    float* const least = candidates_.in_child(c).nearest_lower;
    const float aside = kMostAside * candidates_.child(c).radius;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      if (candidates_.in_child(c).from_centre[k] > aside * aside) least[k] = 0;
    }
    const GroupEnergy::Row at = energy.of_candidates(c, points_);
    std::size_t best = kCandidates;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      if (least[k] >= enough && (best == kCandidates || at[k] < at[best])) best = k;
    }
    if (best < kCandidates) move(c, best);
  }

  /// Moves a point together with the neighbour for which the smaller relative radius of both grows most; none if none grows.
  void move_with_neighbour(std::size_t c) {
    const RankedPoint before = points_[c];
    BestCandidate most{spacing_of(c), 0};
    std::size_t best_neighbour = kNobody, best_there = 0;
    for (const std::uint32_t j : neighbours_of(c)) {
      if (j >= points_.size() || points_[j].rank < n_) continue;
      const RankedPoint before_there = points_[j];
      const BestCandidate here = farthest_candidate(c, j);
      move(c, here.index);
      const BestCandidate there = farthest_candidate(j, kNobody);
      move(j, there.index);
      const float value = std::min(spacing_of(c), spacing_of(j));
      if (value > most.value) most = {value, here.index}, best_neighbour = j, best_there = there.index;
      points_[j] = before_there;
      points_[c] = before;
    }
    if (best_neighbour == kNobody) return;
    move(c, most.index);
    move(best_neighbour, best_there);
  }

  float enough(const BestCandidate& best) const {
    return std::min(kTargetRelativeRadius * kTargetRelativeRadius * unit(), kAcceptedShare * best.value);
  }

  bool is_crowded(std::size_t most) const { return neighbours_.size() > most * points_.size(); }
  const RankedPoint& point(std::size_t i) const { return i < points_.size() ? points_[i] : near_[i - points_.size()]; }
  float unit() const { return unit_ * unit_; }

  void find_neighbours() {
    PointColumns columns(points_.size() + near_.size());
    for (std::size_t i = 0; i < columns.x.size(); ++i) {
      const RankedPoint& p = point(i);
      const bool moves = i < points_.size() && p.rank >= n_;
      const Vec3f at = moves ? candidates_.child(i).centre : Vec3f(p.position[0], p.position[1], p.position[2]);
      columns.x[i] = at.x(), columns.y[i] = at.y(), columns.z[i] = at.z();
      columns.root[i] = std::sqrt(static_cast<float>(p.rank + 1));
      columns.radius[i] = moves ? candidates_.child(i).radius : 0;
    }
    std::vector<std::int32_t> is_near(columns.x.size());
    const float reach = kNeighbourRange * unit_;
    first_neighbour_.assign(points_.size() + 1, 0);
    for (std::size_t c = 0; c < points_.size(); ++c) {
      if (points_[c].rank >= n_) {
        mark_near(columns, candidates_.child(c).centre, candidates_.child(c).radius, columns.root[c], reach, is_near.data());
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

  /// Returns the relative radius of a point, the least since the point came.
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
    return std::sqrt(least) / unit_;
  }

  /// Returns the candidate where the point of child c would be farthest from its neighbours, neighbour `but` left out.
  BestCandidate farthest_candidate(std::size_t c, std::size_t but) {
    float* least = candidates_.in_child(c).nearest_lower;
    std::fill_n(least, kCandidates, kFar);
    for (const std::uint32_t j : neighbours_of(c)) {
      const RankedPoint& p = point(j);
      if (j != but) candidates_.take_nearer(c, p, static_cast<float>(std::max(p.rank, points_[c].rank) + 1), least);
    }
    return best_candidate(least, least, 1);
  }

  void move(std::size_t c, std::size_t k) { points_[c] = candidates_.point(c, k, points_[c].rank); }

  GroupCandidates& candidates_;
  std::span<RankedPoint> points_;
  std::span<const RankedPoint> near_;
  std::uint64_t n_;                        // strata of the level, and points of lower levels
  float unit_;                             // lattice_distance() of one point
  std::vector<std::uint32_t> neighbours_;  // of the points of all children, one after the other
  std::vector<std::size_t> first_neighbour_;
};

}  // namespace

void relax_points(GroupCandidates& candidates, std::span<const RankedPoint> near, std::span<RankedPoint> points) {
  Relaxation(candidates, near, points).run();
}

}  // namespace curvecast
