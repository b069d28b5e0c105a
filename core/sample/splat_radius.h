// The radius of a point's disc, such that neighbouring discs overlap.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/curve/surface_curve.h"
#include "core/sample/radius_ladder.h"

namespace curvecast {

class SplatRadius {
 public:
  /// `area_of_point`: the area for which a point stands where the density is 1, in squared units of the file.
  SplatRadius(const SurfaceCurve& curve, double area_of_point)
      : scale_(static_cast<float>(kOverArea * std::sqrt(area_of_point))),
        largest_(largest(curve)),
        square_(largest_ / scale_ * (largest_ / scale_)) {}

  /// Returns the largest radius of any disc: the diagonal of the surface's box.
  static float largest(const Box3d& box) { return static_cast<float>(box.diagonal()); }
  static float largest(const SurfaceCurve& curve) { return largest(curve.box); }

  /// Returns the radius of a point where the density has this value.
  float operator()(float density) const { return std::min(scale_ / std::sqrt(density), largest_); }
  /// Returns the radius of a point that stands for an area, in squared units, but no more than the largest.
  static float of_area(double area, double largest) { return static_cast<float>(std::min(kOverArea * std::sqrt(area), largest)); }
  /// Returns the area for which a point with such a radius stands, unless that is the largest.
  static double area_of_point(float radius) {
    const double side = static_cast<double>(radius) / kOverArea;
    return side * side;
  }
  /// Returns the rung of that radius on RadiusLadder(largest(curve)).
  std::uint8_t rung(float density) const { return RadiusLadder::below(density * square_); }

 private:
  // Radius over the square root of the area for which a point stands. Discs of this size leave next to no holes around jittered
  // points (the coverage radius of such sets is 1.45 at its worst, under 1 nearly everywhere), none around ranked points.
  static constexpr double kOverArea = 1.25;

  float scale_, largest_;
  float square_;  // (largest radius / radius at density 1)^2
};

}  // namespace curvecast
