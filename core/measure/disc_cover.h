// What a set of equal discs shows of the square in which their centres lie (the paper's figure 6).
#pragma once

#include <span>

#include "core/base/vec.h"

namespace curvecast {

/// Returns the share of the unit square that discs of one radius about the points cover, exactly but for rounding: the sum over
/// the points of what the disc has of the point's own Voronoi cell. Preconditions: all points in [0, 1]^2, radius >= 0.
double disc_cover(std::span<const Vec2d> points, double radius);

}  // namespace curvecast
