// In which order the blocks of a level get their points, and which of them notice each other. It does not depend on who asks, so
// that any block can be made by itself, after the few that come before it around.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/curve_strata.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

class BlockOrder {
 public:
  /// Makes ready for blocks of levels below `levels`; of others too, but slower. Keeps the address of `strata`. Immutable: any
  /// number of threads may ask. Runs on all threads of the arena.
  BlockOrder(const CurveStrata& strata, int levels);

  /// Blocks of a level are the strata of this level.
  static int stratum_level(int level) { return level > kBlockLevels ? level - kBlockLevels : 0; }
  static std::uint64_t blocks(int level) { return std::uint64_t{1} << 2 * stratum_level(level); }
  /// Whether of two blocks of one level the first gets its points before the second. Consecutive blocks come in different
  /// quarters of the order, so that few wait for others that wait for others.
  static bool precedes(int level, std::uint64_t first, std::uint64_t second);

  Eigen::AlignedBox3f box(const RankBlock& block) const;
  /// The blocks, ascending, that may have points as near as rank_reach() to places in this one; it is among them itself.
  /// `near_parent`: the same of block index / 4 of the level before; of one block where there is no other, {0}.
  std::vector<std::uint64_t> near(const RankBlock& block, std::span<const std::uint64_t> near_parent) const;

 private:
  const CurveStrata* strata_;
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes_;  // of the strata of each level
};

}  // namespace curvecast
