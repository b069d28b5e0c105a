// How far a point lies from a triangle. Source: Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
#pragma once

#include "core/base/vec.h"

namespace curvecast {

/// Distance of p to the nearest point of the triangle a, b, c, in its units. Any triangle, even one without area.
double triangle_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// The point of the triangle a, b, c that is nearest to p. Any triangle.
Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace curvecast
