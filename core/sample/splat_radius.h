// How large a point's disc has to be for neighbouring discs to overlap.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/curve/surface_curve.h"

namespace curvecast {

class SplatRadius {
 public:
  /// Where the density is 1 a point stands for so much of the surface, squared units.
  SplatRadius(const SurfaceCurve& curve, double area_of_point)
      : scale_(static_cast<float>(kOverArea * std::sqrt(area_of_point))), largest_(static_cast<float>(curve.box.diagonal())) {}

  float operator()(float density) const { return std::min(scale_ / std::sqrt(density), largest_); }

 private:
  // Over the square root of the area. Discs of this size leave next to no holes around jittered points (the coverage radius of
  // such sets is 1.45 at its worst, under 1 nearly everywhere), none around ranked ones.
  static constexpr double kOverArea = 1.25;

  float scale_, largest_;
};

}  // namespace curvecast
