// The second step of filling a stratum group: its new points move within their child strata to where they are farther from
// others.
#pragma once

#include <span>

#include "core/progressive/candidate_points.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

// The relative radius of a point is its distance to the nearest other point over lattice_distance() of the points there are, when
// the later one of the two comes.

/// A candidate is far enough from other points with the target, or with this share of the best candidate's squared distance,
/// whichever is less. Among candidates that are far enough the one nearest to the centre of its stratum is taken.
inline constexpr float kTargetRelativeRadius = 0.64f, kAcceptedShare = 0.85f;

/// Moves those of a group's points (one in each child) whose rank is of the group's level. `near`: points of other groups around.
/// Overwrites nearest_lower of the candidates.
void relax_points(GroupCandidates& candidates, std::span<const RankedPoint> near, std::span<RankedPoint> points);

}  // namespace curvecast
