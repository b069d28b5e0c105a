// How large a point's disc has to be for neighbouring discs to overlap.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/curve/surface_curve.h"
#include "core/sample/radius_ladder.h"

namespace curvecast {

class SplatRadius {
 public:
  /// Where the density is 1 a point stands for so much of the surface, squared units.
  SplatRadius(const SurfaceCurve& curve, double area_of_point)
      : scale_(static_cast<float>(kOverArea * std::sqrt(area_of_point))),
        largest_(largest(curve)),
        square_(largest_ / scale_ * (largest_ / scale_)) {}

  /// No disc is larger.
  static float largest(const SurfaceCurve& curve) { return static_cast<float>(curve.box.diagonal()); }

  float operator()(float density) const { return std::min(scale_ / std::sqrt(density), largest_); }
  /// The same, as a rung of RadiusLadder(largest(curve)).
  std::uint8_t rung(float density) const { return RadiusLadder::below(density * square_); }

 private:
  // Over the square root of the area. Discs of this size leave next to no holes around jittered points (the coverage radius of
  // such sets is 1.45 at its worst, under 1 nearly everywhere), none around ranked ones.
  static constexpr double kOverArea = 1.25;

  float scale_, largest_;
  float square_;  // of the largest radius over that at density 1
};

}  // namespace curvecast
