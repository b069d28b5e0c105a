// What one selection of ranked candidates shows and another does not, and what that changes in a list of points along the curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/capacity.h"
#include "core/progressive/rank_selection.h"

namespace curvecast {

struct RankDelta {
  /// A point that both show, with another disc.
  struct Resized {
    RankRef point;      // of the later selection's tree
    std::uint8_t from;  // the rung of its disc before
  };

  std::vector<RankRef> added;    // of the later selection's tree
  std::vector<RankRef> removed;  // of the earlier selection's tree
  std::vector<Resized> resized;  // where both selections know their discs

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [a, r, s] = *this;
    return capacity_bytes(a, r, s);
  }
};

/// The trees may differ as far as the one has grown from the other. `discs`: the earlier selection's rungs; where both are known,
/// what becomes of them is told. What `out` held before is lost.
void compare(const RankSelection& earlier, std::span<const std::uint8_t> discs, const RankSelection& later, RankDelta& out);

/// The same as places in the lists of all points that are shown, which run along the curve; each ascending.
struct ListDelta {
  std::vector<std::uint32_t> added;    // in the later list
  std::vector<std::uint32_t> removed;  // in the earlier list
  std::vector<std::uint32_t> resized;  // in the later list

  // locate()'s own affair.
  std::vector<std::uint64_t> keys, scratch;
  std::vector<std::uint32_t> places;

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [a, r, s, k, c, p] = *this;
    return capacity_bytes(a, r, s, k, c, p);
  }
};

/// Brings the changes into the order of the curve, and finds out where they stand.
void locate(const RankTree& earlier, const RankSelection& later, RankDelta& delta, ListDelta& out);

}  // namespace curvecast
