// Finds ranked points again from where they lie along the curve: the choice among candidates, which took the time, is made.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// What is kept of a ranked point.
struct RankedPosition {
  std::uint64_t curve_position, rank;  // as of RankedPoint
};

/// Returns the point of rank 0, which the seed places.
RankedPoint first_ranked_point(const CurveStrata& strata, std::uint64_t seed);

/// Returns the points of all ranks down to a level, to the bit as ProgressiveRanks::make() gave them with this seed. `positions`:
/// in curve order, one in each stratum of the level. InvalidArgument where that is not so, or the level is below 0 or above
/// kFirstFreeLevel: points of free groups do not lie where their candidates do. Cancelled.
absl::StatusOr<std::vector<RankedPoint>> find_ranked_points(const CurveStrata& strata, int level, std::uint64_t seed,
                                                            std::span<const RankedPosition> positions,
                                                            const ExecutionContext& context = {});

}  // namespace curvecast
