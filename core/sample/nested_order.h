// An order of points in which every prefix is even: coarser sets are prefixes of finer ones.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"

namespace curvecast {

/// Returns the rank of each point, 0 .. N - 1: the points of the lowest ranks are as evenly spread as these points allow, however
/// many they are. `positions`: along a curve that passes as much of the density from one to the next, as sampling lays them.
/// `radii`: N, relative to the distance of a point's neighbours. `seed`: of where the order begins. The
/// 4^l lowest ranks have one in each of 4^l equal parts of the curve, as long as quarters of these have two points: from one
/// level to the next the opposite quarter comes before the others, parts come in the order of their reversed bits, and of a few
/// points of a quarter that is taken which is farthest from all taken before (Eldar et al., "The farthest point strategy for
/// progressive image sampling", 1997). The same for any number of threads. Errors: MemoryClaim's; Cancelled.
absl::StatusOr<std::vector<std::uint32_t>> nested_order(std::span<const Vec3f> positions, std::span<const float> radii,
                                                        std::uint64_t seed, const ExecutionContext& context = {});

}  // namespace curvecast
