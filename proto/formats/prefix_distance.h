// SPDX-License-Identifier: Apache-2.0
// How far points are from the coarser set that the first of them are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace curvecast::formats {

/// Returns the distance of each point to the nearest of those whose rank is below `prefix`; 0 for these themselves. Precondition: there
/// is such a point.
std::vector<float> distances_to_prefix(std::span<const std::array<float, 3>> positions, std::span<const std::uint32_t> ranks,
                                       std::uint64_t prefix);

}  // namespace curvecast::formats
