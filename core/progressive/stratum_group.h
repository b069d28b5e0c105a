// The points that come next in some neighbouring strata: places and ranks of 3 more for each, so that every prefix of the ranks
// is spread evenly and no two points of it come near. Blocks take turns; in each the next point goes to the stratum that is least
// crowded, near and farther off, and there to a place apart from others. Compare Eldar et al., "The farthest point strategy for
// progressive image sampling" (1997), which has neither strata nor crowds.
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/curve_strata.h"

namespace curvecast {

struct RankedPoint {
  std::uint64_t coordinate;  // along the curve, 2^64 = the whole area: its highest 2 l bits are its stratum of level l
  float position[3];         // relative to the curve's origin
  float normal[3];           // unit length
  std::uint32_t vertex;      // the curve vertex where it is, or whose leaf holds it
  std::uint32_t rank;        // 0, 1, 2 ...: how many come before it
};

/// Strata whose points are placed together.
inline constexpr int kBlockLevels = 3;
inline constexpr std::size_t kBlockStrata = std::size_t{1} << 2 * kBlockLevels;

/// Block `index` of level l holds the strata [index s, index s + s) of that level, where s is kBlockStrata or, of the first
/// levels, all 4^l.
struct RankBlock {
  int level;
  std::uint64_t index;

  std::uint64_t size() const { return level < kBlockLevels ? std::uint64_t{1} << 2 * level : kBlockStrata; }
};

/// Bits of a coordinate within a stratum of the level after.
constexpr int child_shift(int level) { return 62 - 2 * level; }

/// Up to this distance points of a level take notice of each other.
float rank_reach(double total_area, int level);

/// Places 3 points into each of a block's s strata and gives them ranks in [4^l, 4^(l+1)), unique among all blocks of the level.
/// `base` has the s points of lower ranks, one per stratum. Of other blocks as far as rank_reach(): `done` has all points of
/// those that were done before, `open` the points of lower ranks of the others. Writes 4 s `points`: one for each stratum of
/// level l + 1, those of `base` among them.
void fill_rank_block(const CurveStrata& strata, const RankBlock& block, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                     std::span<RankedPoint> points);

}  // namespace curvecast
