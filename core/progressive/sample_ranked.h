// The progressive sampler for a view: selects ranked points by density, then gathers their data.
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

// In all functions `curve` is the curve on which the tree's points were made, and `fixed` is what make_fixed_density() makes of
// that curve and the density's terms; null will do where ViewFactor::is_fixed_by_detail().

/// Selects the n points that a density shows first, fewer where the tree has no more, and finds their discs. Writes
/// workspace.selection; the chunks that the tree lacks for it are workspace.selection.lacking.
/// InvalidArgument: n = 0, a bad density. OutOfRange: n > kMaxPoints. FailedPrecondition: the density is zero everywhere.
/// `expected_scale`: see RankSelector::select().
absl::Status select_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace, double expected_scale = 0);

/// Writes the data of the points `refs` of a selection to `points`, in this order; their places on faces only if asked for. Radii
/// are those of the refs' rungs.
void gather_ranked(const SurfaceCurve& curve, const RankSelection& selection, std::span<const RankRef> refs, PointSet& points,
                   bool with_places = false);

/// Writes the data of all points of workspace.selection to workspace.points, in curve order.
void list_ranked(const SurfaceCurve& curve, RankedWorkspace& workspace, bool with_places = false);

/// Calls select_ranked(), then list_ranked(). Errors as of select_ranked().
absl::Status sample_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace);

}  // namespace curvecast
