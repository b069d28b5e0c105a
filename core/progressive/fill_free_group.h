// Fills a stratum group of a deep level: quickly, and by points of lower levels alone. Beside groups of its level it stands as if
// they were empty, so that any part of the surface can be made without what is around it: a view from nearby needs its ranks now.
// The points are a little less even than those of fill_stratum_group().
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// Does what fill_stratum_group() does, with all groups around open: strata get their points in turns, in the order of the
/// reversed bits of their index, each in the child and at the candidate that is farthest from all points. `open`: the points of
/// lower levels of the groups around, as far as free_influence_radius().
void fill_free_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> open, std::uint64_t seed, std::span<RankedPoint> points);

/// Returns up to which distance points of lower levels influence those of a level.
float free_influence_radius(double total_area, int level);

}  // namespace curvecast
