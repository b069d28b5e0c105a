// The half-angle of mean value coordinates.
// Source: Floater, "Mean value coordinates" (2003).
#pragma once

#include <algorithm>

#include "core/base/vec.h"

namespace curvecast {

/// Tangent of half the angle between u and v, kept away from the extremes that slivers have. A neighbour at the end of u has the
/// weight (tangent before + tangent after) / |u|.
inline double half_tangent(const Vec3d& u, const Vec3d& v) {
  const double lengths = u.norm() * v.norm();
  const double cosine = u.dot(v);
  const double sine = u.cross(v).norm();
  const double tangent = cosine > 0 ? sine / (lengths + cosine) : (lengths - cosine) / std::max(sine, 1e-300);
  return std::clamp(tangent, 1e-4, 1e4);
}

}  // namespace curvecast
