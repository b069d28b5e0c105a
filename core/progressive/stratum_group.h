// Fills a group of neighbouring strata with the points of the next level: three more for each stratum, so that every prefix of
// the ranks is spread evenly and no two points of it come near. Groups take turns. In each the next point goes to the child
// stratum with the least energy and the widest gap, and there to a candidate far from other points. Compare Eldar et al., "The
// farthest point strategy for progressive image sampling" (1997), which has neither strata nor an energy.
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/curve_strata.h"

namespace curvecast {

/// A point with a fixed position and rank.
struct RankedPoint : CurvePoint {
  std::uint64_t curve_position;  // in steps of 2^-64 of the whole area: the highest 2 l bits are the point's stratum of level l
  std::uint64_t rank;            // see progressive.h
};

/// A group has 4^kGroupLevels strata.
inline constexpr int kGroupLevels = 3;
inline constexpr std::size_t kGroupStrata = std::size_t{1} << 2 * kGroupLevels;

/// Strata of a level whose points are placed together: [index s, index s + s), where s is kGroupStrata or, of the first levels,
/// all 4^level.
struct StratumGroup {
  int level;
  std::uint64_t index;

  std::uint64_t size() const { return level < kGroupLevels ? std::uint64_t{1} << 2 * level : kGroupStrata; }
};

/// Returns how many bits of a curve position lie below a stratum of the level after: position >> child_shift(level) is that
/// stratum.
constexpr int child_shift(int level) { return 62 - 2 * level; }

/// Returns up to which distance points of a level influence each other.
float influence_radius(double total_area, int level);

/// Places 3 points into each of a group's s strata and gives them ranks in [4^l, 4^(l+1)), l the group's level; no other group of
/// the level gives the same ranks. `base`: the s points of lower ranks, one in each stratum. Points of other groups, as far as
/// influence_radius(): `done` has all points of groups that come before this one in GroupOrder, `open` the points of lower ranks
/// of the other groups. Writes 4 s `points`: one for each stratum of level l + 1, those of `base` among them.
void fill_stratum_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                        std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                        std::span<RankedPoint> points);

}  // namespace curvecast
