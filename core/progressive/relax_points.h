// The last step of a block's points: they move within their strata, to where they keep farther from each other.
#pragma once

#include <span>

#include "core/progressive/candidate_points.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

/// Relative radius: with this much a point keeps apart well; so it does with this part of what it could have.
inline constexpr float kEnough = 0.64f, kMost = 0.85f;

/// Moves those of a block's points, one in each child, whose rank is not of a level before. `near`: points of other blocks
/// around. Overwrites what `candidates` know of distances.
void relax_ranks(GroupCandidates& candidates, std::span<const RankedPoint> near, std::span<RankedPoint> points);

}  // namespace curvecast
