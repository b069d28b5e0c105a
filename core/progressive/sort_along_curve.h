// Sorts by places along the curve, which are spread evenly over all 32-bit numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast {

/// Ascending by the upper 32 bits, those with the same in the order in which they come (a radix sort, and insertion for
/// the last few digits).
/// `scratch` is memory to be used again.
void sort_by_place(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch);

}  // namespace curvecast
