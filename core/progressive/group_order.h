// The order in which the stratum groups of a level get their points, and which groups lie so near that they notice each other's
// points. The order does not depend on who asks, so that any group can be made by itself, after the few around it that come
// before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/random.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// Names a group among those of all levels.
struct GroupKey {
  int level;
  std::uint64_t index;
  bool operator==(const GroupKey&) const = default;
};
struct GroupHash {
  std::size_t operator()(const GroupKey& key) const {
    return mix_bits(key.index << 5 | static_cast<std::uint64_t>(key.level));  // there are fewer than 32 levels
  }
};
template <typename Value>
using GroupMap = std::unordered_map<GroupKey, Value, GroupHash>;

/// Where a group lies: places spread evenly over it, as many as a full group has strata, and a box around all of it.
struct GroupShape {
  float x[kGroupStrata], y[kGroupStrata], z[kGroupStrata];  // relative to the curve's origin
  Eigen::AlignedBox3f box;
};
/// Shapes of groups of deep levels.
using GroupShapes = GroupMap<GroupShape>;

/// From this level on groups are filled by fill_free_group().
inline constexpr int kFirstFreeLevel = 8;
/// From this level on groups hardly wait for each other.
inline constexpr int kFirstLooseLevel = 9;

class GroupOrder {
 public:
  /// Prepares the shapes of the groups of levels below `levels`; those of deeper levels are found when asked for, which is
  /// slower. Keeps the address of `strata`. Immutable: any number of threads may ask. Runs on all threads of the arena.
  GroupOrder(const CurveStrata& strata, int levels);

  /// Each group of a level is one stratum of this lower level.
  static int stratum_level(int level) { return level > kGroupLevels ? level - kGroupLevels : 0; }
  /// Returns the number of groups of a level.
  static std::uint64_t count(int level) { return std::uint64_t{1} << 2 * stratum_level(level); }
  /// Returns up to which distance points influence those of a group of a level.
  static float influence_radius(double total_area, int level);
  /// Says whether groups of a level are free: filled by fill_free_group().
  static bool is_free(int level) { return level >= kFirstFreeLevel; }
  /// Says whether the second of two groups of one level waits for the first, where they are near each other, and heeds its
  /// points. From kFirstLooseLevel on those of odd indices wait for those of even ones, which lie about them like the squares of
  /// a chessboard. Others wait in the order of the reversed bits of the index: groups that follow one another on the curve come
  /// in different quarters of the order, so that chains of groups that wait for one another are short.
  static bool precedes(int level, std::uint64_t first, std::uint64_t second);

  /// Says whether the shapes of a level's groups are prepared.
  bool has_shapes(int level) const { return stratum_level(level) < static_cast<int>(shapes_.size()); }
  /// Finds where a group lies, prepared or not.
  GroupShape find_shape(const StratumGroup& group) const;
  /// Returns where a group lies. Precondition: its shape is prepared, or among `deep`.
  const GroupShape& shape(const StratumGroup& group, const GroupShapes& deep) const;
  /// Returns the groups of the same level (ascending) that may have points within influence_radius() of positions in this one;
  /// the group itself is among them. `near_parent`: near() of the group index / 4 of the level before; not read where the level
  /// has one group only. Precondition: the shapes of the groups below those of near_parent are prepared, or among `deep`.
  std::vector<std::uint64_t> near(const StratumGroup& group, std::span<const std::uint64_t> near_parent,
                                  const GroupShapes& deep) const;

 private:
  const CurveStrata* strata_;
  std::vector<std::vector<GroupShape>> shapes_;  // [stratum level][group]
};

}  // namespace curvecast
