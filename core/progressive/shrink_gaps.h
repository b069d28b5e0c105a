// What a block's points leave open: the widest holes are closed by moving points about them within their strata. Holes count at
// all times: a point that comes late leaves one open that is wide beside the distance between the points there are by then.
#pragma once

#include <span>

#include "core/progressive/candidate_points.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

/// Relative to the distance of neighbours in a hexagonal lattice of the points there are: wider holes are closed where points can
/// move so that no other hole becomes as bad.
inline constexpr float kWideHole = 0.95f;

/// Moves those of a block's points, one in each child, whose rank is not of a level before; none comes nearer to another than
/// half the lattice distance. Of other blocks `done` has the points around that have their ranks, `open` those of lower ranks
/// where others are still to come.
void close_holes(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
                 std::span<const RankedPoint> open, std::span<RankedPoint> points);

}  // namespace curvecast
