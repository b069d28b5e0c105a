// A curve vertex as a differential point: beside place and normal, how the surface bends around it. Source: Kalaiah, Varshney,
// "Differential point rendering" (2001); paper, section 2.
#pragma once

#include "core/curve/surface_curve.h"
#include "core/curve/tangent_frame.h"

namespace curvecast {

/// Unit vector along which the curvature is curvature_max, in one of its two senses; any tangent where the two are equal. The
/// direction of curvature_min is at right angles to it and the normal.
inline Vec3f principal_direction_max(const SurfaceCurve& curve, std::size_t l) {
  return unpack_direction(curve.direction[l], curve.normal(l));
}

/// Product of the principal curvatures, 1/unit^2.
inline float gaussian_curvature(const SurfaceCurve& curve, std::size_t l) {
  return curve.curvature_min[l] * curve.curvature_max[l];
}

/// Mean of the principal curvatures, 1/unit; positive where the surface is convex.
inline float mean_curvature(const SurfaceCurve& curve, std::size_t l) {
  return 0.5f * (curve.curvature_min[l] + curve.curvature_max[l]);
}

}  // namespace curvecast
