// Points far from each other out of many random ones: what is common for Poisson-disk sets on surfaces, a peer to compare with.
// Source: Yuksel, "Sample elimination for generating Poisson disk sample sets" (2015), sections 3 and 5.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/measure/point_cloud.h"

namespace curvecast::cli::bench {

/// Takes points away, again and again the one with the greatest weight, until n are left, and returns their indices, ascending.
/// A point's weight is the sum of (1 - d / 2 r_max)^8 over all others at a distance d below 2 r_max = 2 packing_radius(area, n);
/// distances below 2 r_min count as 2 r_min, with r_min = 0.65 (1 - (n / M)^1.5) r_max. `candidates`: M of them, about 5 n,
/// random and uniform in area; `area`: of their surface, in squared units. Of equal weights the smaller index goes first. The
/// same for any number of threads. Cancelled. Precondition: 0 < n <= M.
absl::StatusOr<std::vector<std::uint32_t>> eliminate_samples(const PointCloud& candidates, double area, std::size_t n,
                                                             const ExecutionContext& context = {});

}  // namespace curvecast::cli::bench
