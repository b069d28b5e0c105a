// How evenly points lie in the unit square: the star discrepancy. Source: Bundschuh, Zhu, "A method for exact calculation of the
// discrepancy of low-dimensional finite point sets I" (1993), theorem 2.
#pragma once

#include <span>

#include "core/base/vec.h"

namespace curvecast {

/// Returns the supremum of |share of the points - area| over all boxes [0, x) x [0, y) in the unit square, exactly but for
/// rounding. Takes time that grows with the square of the number of points: a few milliseconds for 3,000. Preconditions: there is
/// a point; all are in [0, 1]^2.
double star_discrepancy(std::span<const Vec2d> points);

}  // namespace curvecast
