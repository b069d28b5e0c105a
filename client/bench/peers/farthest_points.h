// Farthest-point order, which people who learn from point clouds use: a peer to compare with. Source: Eldar, Lindenbaum, Porat,
// Zeevi, "The farthest point strategy for progressive image sampling" (1997), over candidates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast::cli::bench {

/// Returns the indices of the n points in their order: the first, then again and again the one that is farthest from all before
/// it; of several the one with the smaller index. n is at most their number.
std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t n);

}  // namespace curvecast::cli::bench
