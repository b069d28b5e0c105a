// The part of a triangle that lies in a ball.
#pragma once

#include "core/base/vec.h"

namespace curvecast {

/// Area of the triangle a, b, c within `radius` of the centre, exact but for rounding, which is relative to the square of the
/// radius: the ball cuts a circle out of the triangle's plane, and each side of the triangle spans a part of it, of triangles and
/// sectors, with the circle's middle.
double area_in_ball(const Vec3d& centre, double radius, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace curvecast
