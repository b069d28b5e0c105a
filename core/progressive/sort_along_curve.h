// Sorts points by curve position. The positions are spread evenly over all 32-bit numbers, which the method counts on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast {

/// Sorts keys by their upper 32 bits, the curve positions; keys with the same position keep their order. A radix sort, and
/// insertion for the last few digits. `scratch` is memory that is used again.
void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch);

}  // namespace curvecast
