// Fills a stratum group of a deep level: quickly, and with little of what is around it, so that any part of the surface can be
// made for a view from nearby, which needs its ranks now. The points are a little less even than those of fill_stratum_group().
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// Does what fill_stratum_group() does: strata get their points in turns, in the order of the reversed bits of their index, each
/// in the child and at the candidate that is farthest from all points. `done`: all points of the groups around that precede this
/// one; `open`: those of lower levels of the others; both as far as free_influence_radius().
void fill_free_group(const CurveStrata& strata, const StratumGroup& group, std::span<const RankedPoint> base,
                     std::span<const RankedPoint> done, std::span<const RankedPoint> open, std::uint64_t seed,
                     std::span<RankedPoint> points);

/// Returns up to which distance points of lower levels influence those of a level.
float free_influence_radius(double total_area, int level);

}  // namespace curvecast
