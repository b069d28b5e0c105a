// The order in which the stratum groups of a level get their points, and which groups lie so near that they notice each other's
// points. The order does not depend on who asks, so that any group can be made by itself, after the few around it that come
// before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

class GroupOrder {
 public:
  /// Prepares the boxes of the groups of levels below `levels`; those of deeper levels are found when asked for, which is slower.
  /// Keeps the address of `strata`. Immutable: any number of threads may ask. Runs on all threads of the arena.
  GroupOrder(const CurveStrata& strata, int levels);

  /// Each group of a level is one stratum of this lower level.
  static int stratum_level(int level) { return level > kGroupLevels ? level - kGroupLevels : 0; }
  /// Returns the number of groups of a level.
  static std::uint64_t count(int level) { return std::uint64_t{1} << 2 * stratum_level(level); }
  /// Says whether of two groups of one level the first gets its points before the second. The order is that of the reversed bits
  /// of the index: groups that follow one another on the curve come in different quarters of the order, so that chains of groups
  /// that wait for one another are short.
  static bool precedes(int level, std::uint64_t first, std::uint64_t second);

  /// Returns a box around the leaves of a group.
  Eigen::AlignedBox3f box(const StratumGroup& group) const;
  /// Returns the groups of the same level (ascending) that may have points within influence_radius() of positions in this one;
  /// the group itself is among them. `near_parent`: near() of the group index / 4 of the level before; not read where the level
  /// has one group only.
  std::vector<std::uint64_t> near(const StratumGroup& group, std::span<const std::uint64_t> near_parent) const;

 private:
  const CurveStrata* strata_;
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes_;  // [stratum level][group]
};

}  // namespace curvecast
