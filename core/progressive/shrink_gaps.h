// The last step of filling a stratum group: where a gap between its points is wide, a point nearby moves into it. A gap is a
// place far from all points; the widest gap of a point set is its coverage radius. The gaps at all times count: while a point is
// still to come, the gap that it will fill is measured by the distance between the fewer points there are until then.
#pragma once

#include <span>

#include "core/progressive/candidate_points.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// The radius of a gap, over lattice_distance() of the points there are, beyond which the gap is shrunk.
inline constexpr float kWideGap = 0.92f;

/// Moves those of a group's points (one in each child) whose rank is of the group's level, if that shrinks a wide gap by more
/// than it widens others. No point comes nearer to another than half the lattice distance. `done`: all points around of groups
/// that were filled before. `open`: points of lower levels of groups around that are still to be filled.
void shrink_gaps(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
                 std::span<const RankedPoint> open, std::span<RankedPoint> points);

}  // namespace curvecast
