// Evaluates the density terms that are the same for all cameras on the curve (paper, section 3.4).
#pragma once

#include <absl/status/status.h>

#include <span>

#include "core/density/density.h"

namespace curvecast {

/// Multiplies each density[l] (L entries) by a term's value at vertex l, up to a factor that is the same everywhere: attributes,
/// brushes and expressions are scaled to 1 at their largest, so that no sum overflows. Terms of a camera count as 1, but for
/// what a picture term sees of the surface alone.
/// InvalidArgument: the curve has no such attribute, an expression is wrong, a value is infinite (says where). Precondition:
/// check_density() finds nothing. Errors of the context as of evaluate_expression() and paint().
absl::Status multiply_fixed_term(const SurfaceCurve& curve, const DensityTerm& term, std::span<float> density,
                                 const ExecutionContext& context = {});

}  // namespace curvecast
