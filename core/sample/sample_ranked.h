// A point set of ranked candidates for a view: selection, then the points' data.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <memory>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/density/fixed_density.h"
#include "core/sample/rank_tree.h"
#include "core/sample/resample_workspace.h"

namespace curvecast {

/// Writes to workspace.points, in the order of the curve and with their ranks, the n candidates that a density shows first; fewer
/// where there are no more. What the tree lacks for it is workspace.selection.lacking. `curve`: that which the tree's ranks were
/// made for; `fixed`: what make_fixed_density() makes of it and the density.
/// InvalidArgument: n = 0, a bad density. OutOfRange: n > kMaxPoints. FailedPrecondition: the density is zero everywhere.
absl::Status sample_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, ResampleWorkspace& workspace);

}  // namespace curvecast
