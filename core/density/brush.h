// Paint on the surface: dabs of the brush, one over the other.
#pragma once

#include <absl/status/status.h>

#include <span>

#include "core/base/execution_context.h"
#include "core/curve/surface_curve.h"
#include "core/density/density.h"

namespace curvecast {

/// Lays dabs, one after the other, over the paint at each curve vertex (L entries): where a dab has the weight w, paint p becomes
/// p + w (factor - p). Looks only at blocks of the curve that a dab reaches. Cancelled, or DeadlineExceeded beyond the context's
/// limit, between two dabs.
absl::Status paint(const SurfaceCurve& curve, std::span<const Dab> dabs, std::span<float> values,
                   const ExecutionContext& context = {});

/// Returns what paint over 1 is multiplied by, so that it is 1 at most.
float paint_scale(std::span<const Dab> dabs);

}  // namespace curvecast
