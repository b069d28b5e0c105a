// Sorts points by curve position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast {

inline constexpr int kIndexBits = 22;  // enough for kMaxPoints
inline constexpr std::uint64_t kIndexMask = (std::uint64_t{1} << kIndexBits) - 1;

/// Returns the key of item `index` of a list, which has a curve position in steps of 2^-64: its highest 42 bits, which tell all
/// strata apart, and the index.
constexpr std::uint64_t curve_key(std::uint64_t curve_position, std::uint64_t index) {
  return (curve_position & ~kIndexMask) | index;
}

/// Sorts keys by their curve positions; keys with the same position keep their order. A radix sort on the highest digits in which
/// the keys differ, and insertion for the last few: it counts on positions that are spread about evenly between the least and the
/// greatest, and is slower where they are not. `scratch` is memory that is used again.
void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch);

/// Sorts keys as above, and writes the items to `sorted` in their order.
template <typename Item>
void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch, const std::vector<Item>& items,
                      std::vector<Item>& sorted) {
  sort_along_curve(keys, scratch);
  sorted.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) sorted[i] = items[keys[i] & kIndexMask];
}

}  // namespace curvecast
