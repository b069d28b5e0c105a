// How far apart points can be on a plane.
#pragma once

#include <cmath>
#include <numbers>

namespace curvecast {

/// Returns the distance of neighbours where n points keep as far apart as they can on a plane of that area, in a hexagonal
/// lattice. In the units whose square the area has.
inline double packed_distance(double area, double n) { return std::sqrt(2 * area / (std::numbers::sqrt3 * n)); }

}  // namespace curvecast
