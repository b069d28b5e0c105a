// Makes a curve finer where demands find it too coarse (paper, sections 3.2 and 4.5).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/execution_context.h"
#include "core/curve/curve_base.h"
#include "core/curve/surface_curve.h"
#include "core/refine/curve_resolution.h"

namespace curvecast {

struct RefineOptions {
  double omega = 10;                        // curve vertices per point
  std::uint64_t max_vertices = 20'000'000;  // of the finer curve
  std::uint64_t max_points = 0;             // the greatest N among demands of the curve's base density, if any
};

struct RefinedCurve {
  std::shared_ptr<SurfaceCurve> curve;  // revision + 1; null: no leaf can be divided, by its key or by the limit
  double divisor = 1;                   // above 1: the demands were lowered by this to stay within the limit
};

/// Makes the next revision of a curve, fine enough for all of the demands as far as that goes; never coarser anywhere. Where
/// nearly all leaves want more levels, all are raised (subdivide_all()) first, then the others are split (split_leaves()). A
/// density that varies within a leaf may find its parts too coarse again. Errors as of evaluate_density; DataLoss: the base is
/// damaged; Cancelled.
absl::StatusOr<RefinedCurve> refine(const CurveBase& base, const SurfaceCurve& curve, std::span<const CurveDemand> demands,
                                    const RefineOptions& options, const ExecutionContext& context = {});

}  // namespace curvecast
