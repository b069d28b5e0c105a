#include "core/progressive/stratum_group.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/reversed_bits.h"
#include "core/progressive/candidate_points.h"
#include "core/progressive/point_energy.h"
#include "core/progressive/relax_points.h"
#include "core/progressive/shrink_gaps.h"

namespace curvecast {
namespace {

// README.md says where these come from. Distances are in lattice distances of the points there are.
constexpr float kEnergyRange = 4;              // up to this distance the energy counts points
constexpr float kSpacingRange = 1.1f;          // no point is too near beyond this distance
constexpr float kRoomyRelativeRadius = 0.53f;  // a child with a candidate this far from all points may have the next one
constexpr float kGapWeight = 0.75f;            // energy for which a gap with a radius of one lattice distance counts

class GroupFiller {
 public:
  GroupFiller(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed, std::span<RankedPoint> points)
      : group_(group),
        n_(std::uint64_t{1} << 2 * group.level),
        area_(strata.total_area()),
        points_(points),
        strata_(strata),
        candidates_(strata, group, seed) {}

  void fill(std::span<const RankedPoint> base, std::span<const RankedPoint> done, std::span<const RankedPoint> open) {
    for (const RankedPoint& p : base) {
      const std::size_t c = p.curve_position >> child_shift(group_.level) & (points_.size() - 1);
      points_[c] = p;
      candidates_.child(c).has_point = true;
    }
    const std::vector<RankedPoint> near = near_points(done, open);
    const float reach = lattice_distance(area_, static_cast<double>(n_));
    gap_.assign(points_.size(), reach * reach);
    for (const RankedPoint& p : base) take(p, reach);
    for (const RankedPoint& p : near) take(p, reach);
    take_turns(base, done);
    relax_points(candidates_, near, points_);
    shrink_gaps(strata_, candidates_, near_points(done, {}), open, points_);
  }

 private:
  /// Returns the points of other groups that may be too near to the group's.
  std::vector<RankedPoint> near_points(std::span<const RankedPoint> done, std::span<const RankedPoint> open) const {
    const Eigen::AlignedBox3f box = candidates_.box();
    const float reach = lattice_distance(area_, static_cast<double>(n_));
    std::vector<RankedPoint> near;
    for (const std::span<const RankedPoint> points : {done, open}) {
      std::copy_if(points.begin(), points.end(), std::back_inserter(near), [&](const RankedPoint& p) {
        return box.squaredExteriorDistance(Vec3f(p.position[0], p.position[1], p.position[2])) <= reach * reach;
      });
    }
    return near;
  }

  /// Notes a point's distance in all children that have no point yet.
  void take(const RankedPoint& p, float reach, bool is_new = false) {
    const bool comes_later = !is_new && p.rank >= n_;
    std::array<std::int32_t, 4 * kGroupStrata> is_near;
    candidates_.mark_near(p.position, reach, is_near.data());
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (!is_near[c] || candidates_.child(c).has_point) continue;
      CandidatePoints& candidates = candidates_.in_child(c);
      candidates_.take_nearer(c, p, comes_later ? static_cast<float>(p.rank + 1) : 1,
                              comes_later ? candidates.nearest_higher : candidates.nearest_lower);
      if (!comes_later) gap_[c] = largest_of(candidates.nearest_lower);
    }
  }

  /// Returns the energy that the points of lower levels put on the children. Groups that are not filled yet count as even.
  PointEnergy energy_at_first(std::span<const RankedPoint> base, std::span<const RankedPoint> done) const {
    std::vector<Vec3f> centres;
    for (std::size_t c = 0; c < candidates_.size(); ++c) centres.push_back(candidates_.child(c).centre);
    PointEnergy energy(centres, kEnergyRange * lattice_distance(area_, static_cast<double>(n_)));
    for (const Vec3f& centre : centres) energy.expect(centre.data());
    for (const RankedPoint& p : base) energy.add(p.position);
    for (const RankedPoint& p : done) {
      energy.expect(p.position);
      if (p.rank < n_) energy.add(p.position);
    }
    return energy;
  }

  /// Lists the free children of strata that are not ahead of others, with their excess of energy less what their gap counts.
  using Queue = std::vector<std::pair<float, std::size_t>>;
  Queue queue(const PointEnergy& energy, float count, std::uint64_t round) const {
    const float part = count / static_cast<float>(4 * n_),
                weight = kGapWeight / lattice_distance(area_, static_cast<double>(count));
    Queue queue;
    for (std::size_t s = 0; s < point_count_.size(); ++s) {
      if (point_count_[s] > 1 + round / point_count_.size()) continue;
      for (std::size_t c = 4 * s; c < 4 * s + 4; ++c) {
        if (!candidates_.child(c).has_point) queue.emplace_back(energy.excess(c, part) - weight * std::sqrt(gap_[c]), c);
      }
    }
    return queue;
  }

  void take_turns(std::span<const RankedPoint> base, std::span<const RankedPoint> done) {
    PointEnergy energy = energy_at_first(base, done);
    std::vector<const RankedPoint*> later;  // points of this level in groups filled before, by rank
    for (const RankedPoint& p : done) {
      if (p.rank >= n_) later.push_back(&p);
    }
    std::sort(later.begin(), later.end(), [](const RankedPoint* a, const RankedPoint* b) { return a->rank < b->rank; });
    auto next = later.begin();
    point_count_.assign(group_.size(), 1);
    const std::uint64_t groups = n_ / group_.size(), turn = reversed_bits(group_.index, std::bit_width(groups) - 1);
    for (std::uint64_t round = 0; round < 3 * group_.size(); ++round) {
      const std::uint64_t rank = n_ + round * groups + turn;
      for (; next != later.end() && (*next)->rank < rank; ++next) energy.add((*next)->position);
      const auto count = static_cast<float>(rank + 1);
      const std::size_t c = put_next(queue(energy, count, round), rank);
      take(points_[c], kSpacingRange * lattice_distance(area_, static_cast<double>(count)), true);
      energy.add(points_[c].position);
    }
  }

  /// Puts a point into the child with the least value in the queue that is roomy; where none is, into the roomiest. Returns which
  /// child that was.
  std::size_t put_next(Queue queue, std::uint64_t rank) {
    const auto count = static_cast<float>(rank + 1);
    const float unit = lattice_distance(area_, 1);
    BestCandidate best;
    std::size_t chosen = 0;
    while (!queue.empty() && best.value < kRoomyRelativeRadius * kRoomyRelativeRadius * unit * unit) {
      const auto least = std::min_element(queue.begin(), queue.end());
      const std::size_t c = least->second;
      *least = queue.back();
      queue.pop_back();
      const BestCandidate here =
          best_candidate(candidates_.in_child(c).nearest_lower, candidates_.in_child(c).nearest_higher, count);
      if (here.value > best.value) best = here, chosen = c;
    }
    const CandidatePoints& candidates = candidates_.in_child(chosen);
    const float enough = std::min(kTargetRelativeRadius * kTargetRelativeRadius * unit * unit, kAcceptedShare * best.value);
    points_[chosen] = candidates_.point(chosen, central_candidate(candidates, candidates.nearest_higher, count, enough), rank);
    candidates_.child(chosen).has_point = true;
    ++point_count_[chosen / 4];
    return chosen;
  }

  StratumGroup group_;
  std::uint64_t n_;  // strata of the level, and points of lower levels
  double area_;
  std::span<RankedPoint> points_;
  const CurveStrata& strata_;
  GroupCandidates candidates_;
  std::vector<float> gap_;                 // of each child: largest squared distance from a candidate to the nearest point so far
  std::vector<std::uint8_t> point_count_;  // in each stratum
};

}  // namespace

float influence_radius(double total_area, int level) {
  return kEnergyRange * lattice_distance(total_area, std::ldexp(1.0, 2 * level));
}

void fill_stratum_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                        std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                        std::span<RankedPoint> points) {
  GroupFiller(strata, group, seed, points).fill(base, done, open);
}

}  // namespace curvecast
