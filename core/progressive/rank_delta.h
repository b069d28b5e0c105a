// The difference between two selections of ranked points, and what it changes in the list of the selected points along the curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/capacity.h"
#include "core/progressive/rank_selection.h"

namespace curvecast {

struct RankDelta {
  /// A point that both selections show, with discs of different sizes.
  struct Resized {
    RankRef point;      // of the later selection
    std::uint8_t from;  // rung of its disc in the earlier selection
  };

  std::vector<RankRef> added;    // of the later selection
  std::vector<RankRef> removed;  // of the earlier selection
  std::vector<Resized> resized;  // where both selections know their discs

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [a, r, s] = *this;
    return capacity_bytes(a, r, s);
  }
};

/// Writes to `out` which points a later selection adds, removes and resizes; each list chunk by chunk, ascending in a chunk.
/// `discs`: the earlier selection's rungs, or none; points are compared for resizing only if both selections have rungs.
/// Both are selections of the same curve's points.
void compare(const RankSelection& earlier, std::span<const std::uint8_t> discs, const RankSelection& later, RankDelta& out);

/// Indices of changed points in the lists of all selected points, which run along the curve. All are ascending.
struct ListDelta {
  std::vector<std::uint32_t> added;    // in the later list
  std::vector<std::uint32_t> removed;  // in the earlier list
  std::vector<std::uint32_t> resized;  // in the later list

  /// Of locate(), for each list.
  struct Scratch {
    std::vector<std::uint64_t> keys, sorting, curve_positions;

    std::size_t byte_size() const {
      const auto& [k, s, c] = *this;
      return capacity_bytes(k, s, c);
    }
  };
  Scratch of_added, of_removed, of_resized;

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [a, r, s, x, y, z] = *this;
    return capacity_bytes(a, r, s) + x.byte_size() + y.byte_size() + z.byte_size();
  }
};

/// Sorts the changes of `delta` along the curve and writes their indices to `out`: the three lists side by side, where there are
/// cores.
void locate(const RankSelection& earlier, const RankSelection& later, RankDelta& delta, ListDelta& out);

}  // namespace curvecast
