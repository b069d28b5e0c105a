// The points of a selection of ranked candidates, with all that is sent of them.
#pragma once

#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/view_factor.h"
#include "core/sample/point_set.h"
#include "core/sample/rank_delta.h"

namespace curvecast {

/// The points in the order of the curve, with their ranks. `density` and `view`: what the selection was made for; `curve`: what
/// the ranks were made for.
PointSet ranked_points(const SurfaceCurve& curve, const RankSelection& selection, std::vector<RankRef> points,
                       const RankDensity& density, const ViewFactor& view);

}  // namespace curvecast
