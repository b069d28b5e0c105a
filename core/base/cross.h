// The cross product of the plane.
#pragma once

#include "core/base/vec.h"

namespace curvecast {

/// Twice the area of the triangle with a corner at the origin and sides a and b: above 0 where b points to the left of a.
inline double cross(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace curvecast
