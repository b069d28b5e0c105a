// Paint on the surface: dabs of the brush, one over the other.
#pragma once

#include <span>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"

namespace curvecast {

/// Lays dabs, one after the other, over the paint at each curve vertex (L entries): where a dab has the weight w, paint p becomes
/// p + w (factor - p). Looks only at blocks of the curve that a dab reaches.
void paint(const SurfaceCurve& curve, std::span<const Dab> dabs, std::span<float> values);

/// Returns what paint over 1 is multiplied by, so that it is 1 at most.
float paint_scale(std::span<const Dab> dabs);

}  // namespace curvecast
