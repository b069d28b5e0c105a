// Which of a few triangles holds a place in the parameter square.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// Finds the first candidate that holds the place, or else the one in which it lies deepest, so that rounding on a shared side
/// does no harm. Precondition: there is a candidate. `triangles`: anything that gives a UvTriangle for a candidate.
template <typename Triangles>
std::uint32_t deepest_triangle(const Triangles& triangles, std::span<const std::uint32_t> candidates, double u, double v) {
  std::uint32_t best = candidates[0];
  double deepest = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : candidates) {
    const double depth = triangles[t].weights(u, v).minCoeff();
    if (depth <= deepest) continue;
    deepest = depth;
    best = t;
    if (depth > 0) break;
  }
  return best;
}

}  // namespace curvecast
