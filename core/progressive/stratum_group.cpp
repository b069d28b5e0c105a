#include "core/progressive/rank_block.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/reversed_bits.h"
#include "core/progressive/candidate_points.h"
#include "core/progressive/crowding.h"
#include "core/progressive/rank_holes.h"
#include "core/progressive/rank_relaxation.h"

namespace curvecast {
namespace {

constexpr float kFelt = 4;      // in lattice distances: how far points are to be even, the block's own included
constexpr float kReach = 1.1f;  // in lattice distances: no point is too near beyond
constexpr float kRoom = 0.53f;  // relative radius: with this much a child may have its point
constexpr float kHole = 0.75f;  // how much a hole of one lattice distance counts beside crowding

class BlockFiller {
 public:
  BlockFiller(const CurveStrata& strata, const RankBlock& block, std::uint64_t seed, std::span<RankedPoint> points)
      : block_(block),
        n_(std::uint64_t{1} << 2 * block.level),
        area_(strata.total_area()),
        points_(points),
        strata_(strata),
        candidates_(strata, block, seed) {}

  void fill(std::span<const RankedPoint> base, std::span<const RankedPoint> done, std::span<const RankedPoint> open) {
    for (const RankedPoint& p : base) {
      const std::size_t c = p.coordinate >> child_shift(block_.level) & (points_.size() - 1);
      points_[c] = p;
      candidates_.child(c).full = true;
    }
    const std::vector<RankedPoint> near = near_points(done, open);
    const float reach = lattice_distance(area_, static_cast<double>(n_));
    hole_.assign(points_.size(), reach * reach);
    for (const RankedPoint& p : base) take(p, reach);
    for (const RankedPoint& p : near) take(p, reach);
    take_turns(base, done);
    relax_ranks(candidates_, near, points_);
    close_holes(strata_, candidates_, near_points(done, {}), open, points_);
  }

 private:
  /// Those of other blocks that may be too near.
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

  /// All children that have no point yet are told of a point.
  void take(const RankedPoint& p, float reach, bool is_new = false) {
    const bool comes_later = !is_new && p.rank >= n_;
    std::array<std::int32_t, 4 * kBlockStrata> is_near;
    candidates_.mark_near(p.position, reach, is_near.data());
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (!is_near[c] || candidates_.child(c).full) continue;
      CandidatePoints& candidates = candidates_.in_child(c);
      candidates_.take_nearer(c, p, comes_later ? static_cast<float>(p.rank + 1) : 1,
                              comes_later ? candidates.after : candidates.before);
      if (!comes_later) hole_[c] = largest_of(candidates.before);
    }
  }

  /// How crowded the children are with the points before this level. Blocks that are not done count as even.
  Crowding crowding_at_first(std::span<const RankedPoint> base, std::span<const RankedPoint> done) const {
    std::vector<Vec3f> centers;
    for (std::size_t c = 0; c < candidates_.size(); ++c) centers.push_back(candidates_.child(c).center);
    Crowding crowding(centers, kFelt * lattice_distance(area_, static_cast<double>(n_)));
    for (const Vec3f& center : centers) crowding.expect(center.data());
    for (const RankedPoint& p : base) crowding.add(p.position);
    for (const RankedPoint& p : done) {
      crowding.expect(p.position);
      if (p.rank < n_) crowding.add(p.position);
    }
    return crowding;
  }

  /// The free children of strata that are not ahead of others: how crowded they are, less what the hole in them counts.
  using Queue = std::vector<std::pair<float, std::size_t>>;
  Queue queue(const Crowding& crowding, float count, std::uint64_t round) const {
    const float part = count / static_cast<float>(4 * n_), weight = kHole / lattice_distance(area_, static_cast<double>(count));
    Queue queue;
    for (std::size_t s = 0; s < held_.size(); ++s) {
      if (held_[s] > 1 + round / held_.size()) continue;
      for (std::size_t c = 4 * s; c < 4 * s + 4; ++c) {
        if (!candidates_.child(c).full) queue.emplace_back(crowding.at(c, part) - weight * std::sqrt(hole_[c]), c);
      }
    }
    return queue;
  }

  void take_turns(std::span<const RankedPoint> base, std::span<const RankedPoint> done) {
    Crowding crowding = crowding_at_first(base, done);
    std::vector<const RankedPoint*> later;  // of blocks that are done, by rank
    for (const RankedPoint& p : done) {
      if (p.rank >= n_) later.push_back(&p);
    }
    std::sort(later.begin(), later.end(), [](const RankedPoint* a, const RankedPoint* b) { return a->rank < b->rank; });
    auto next = later.begin();
    held_.assign(block_.size(), 1);
    const std::uint64_t blocks = n_ / block_.size(), turn = reversed_bits(block_.index, std::bit_width(blocks) - 1);
    for (std::uint64_t round = 0; round < 3 * block_.size(); ++round) {
      const std::uint64_t rank = n_ + round * blocks + turn;
      for (; next != later.end() && (*next)->rank < rank; ++next) crowding.add((*next)->position);
      const auto count = static_cast<float>(rank + 1);
      const std::size_t c = put_next(queue(crowding, count, round), rank);
      take(points_[c], kReach * lattice_distance(area_, static_cast<double>(count)), true);
      crowding.add(points_[c].position);
    }
  }

  /// Puts a point into the first child that has room; where none has, into the one that has most. Which child that was.
  std::size_t put_next(Queue queue, std::uint64_t rank) {
    const auto count = static_cast<float>(rank + 1);
    const float unit = lattice_distance(area_, 1);
    BestCandidate best;
    std::size_t chosen = 0;
    while (!queue.empty() && best.value < kRoom * kRoom * unit * unit) {
      const auto least = std::min_element(queue.begin(), queue.end());
      const std::size_t c = least->second;
      *least = queue.back();
      queue.pop_back();
      const BestCandidate here = best_candidate(candidates_.in_child(c).before, candidates_.in_child(c).after, count);
      if (here.value > best.value) best = here, chosen = c;
    }
    const CandidatePoints& candidates = candidates_.in_child(chosen);
    const float enough = std::min(kEnough * kEnough * unit * unit, kMost * best.value);
    points_[chosen] = candidates_.point(chosen, central_candidate(candidates, candidates.after, count, enough),
                                        static_cast<std::uint32_t>(rank));
    candidates_.child(chosen).full = true;
    ++held_[chosen / 4];
    return chosen;
  }

  RankBlock block_;
  std::uint64_t n_;  // strata of the level
  double area_;
  std::span<RankedPoint> points_;
  const CurveStrata& strata_;
  GroupCandidates candidates_;
  std::vector<float> hole_;         // square distance of each child's loneliest place from the points so far
  std::vector<std::uint8_t> held_;  // points in each stratum
};

}  // namespace

float rank_reach(double total_area, int level) { return kFelt * lattice_distance(total_area, std::ldexp(1.0, 2 * level)); }

void fill_rank_block(const CurveStrata& strata, const RankBlock& block, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                     std::span<RankedPoint> points) {
  BlockFiller(strata, block, seed, points).fill(base, done, open);
}

}  // namespace curvecast
