// A point set of ranked candidates for a view: selection, then the points' data.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <memory>
#include <span>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/density/fixed_density.h"
#include "core/progressive/rank_tree.h"
#include "core/progressive/ranked_workspace.h"

namespace curvecast {

// `curve`: that which the tree's ranks were made for; `fixed`: what make_fixed_density() makes of it and the density.

/// Selects in workspace.selection the n candidates that a density shows first, and their discs; fewer where there are no more.
/// What the tree lacks for it is workspace.selection.lacking.
/// InvalidArgument: n = 0, a bad density. OutOfRange: n > kMaxPoints. FailedPrecondition: the density is zero everywhere.
absl::Status select_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace);

/// The data of some of the points that a selection shows, in this order.
void gather_ranked(const SurfaceCurve& curve, const RankTree& tree, std::span<const RankRef> refs, PointSet& points);

/// Writes to workspace.points all points of workspace.selection, in the order of the curve, with their ranks.
void list_ranked(const SurfaceCurve& curve, RankedWorkspace& workspace);

/// Selects and lists. Errors as of select_ranked().
absl::Status sample_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace);

}  // namespace curvecast
