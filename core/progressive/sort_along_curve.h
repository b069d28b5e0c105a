// Sorts points by curve position. The positions are spread evenly over all 32-bit numbers, which the method counts on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast {

/// Sorts keys by their upper 32 bits, the curve positions; keys with the same position keep their order. A radix sort, and
/// insertion for the last few digits. `scratch` is memory that is used again.
void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch);

/// Sorts keys as above, and writes the items to `sorted` in their order. The lower 32 bits of a key are the index of its item.
template <typename Item>
void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch, const std::vector<Item>& items,
                      std::vector<Item>& sorted) {
  sort_along_curve(keys, scratch);
  sorted.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) sorted[i] = items[static_cast<std::uint32_t>(keys[i])];
}

}  // namespace curvecast
