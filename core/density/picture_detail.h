// Where a surface has what few points cannot show: where it bends, and where its colour changes.
#pragma once

#include <cstddef>
#include <span>

#include "core/curve/surface_curve.h"

namespace curvecast {

/// A value in [kLeastDetail, 1] at each vertex of a curve, which grows with the larger of two parts: of the larger principal
/// curvature in what counts as strong on this surface (reference_curvature), and of the colour's change per length in
/// kStrongChange. Both change the picture between two points in proportion to their distance. Where the error of a pixel is that
/// change, to the power p, the sum of all errors is least when points are as dense as the change to the power 2 p / (p + 2): 2/3
/// for p = 1, 1 for p = 2. Between them a linear law is as good as any (bench picture).
class PictureDetail {
 public:
  /// Keeps the address of the curve.
  explicit PictureDetail(const SurfaceCurve& curve);

  /// Whether it is 1 everywhere: the surface is flat, and of one colour.
  bool is_one() const { return bend_scale_ == 0 && !has_colour_; }
  float at(std::size_t l) const;

 private:
  float change(std::size_t l) const;

  const SurfaceCurve& curve_;
  float bend_scale_, change_scale_;
  bool has_colour_;
};

/// Multiplies each density[l] (L entries) by it.
void multiply_picture_detail(const SurfaceCurve& curve, std::span<float> density);

/// What a picture term has of a ViewTerm: its s0.
inline constexpr double kPictureFloor = 0.5;
/// How much wider and higher than the picture what it has of a FrustumTerm is: discs beside the picture reach into it.
inline constexpr double kPictureMargin = 1.02;
inline constexpr float kLeastDetail = 0.2f;
/// From black to white so many times in the length of the box's diagonal.
inline constexpr double kStrongChange = 40;

}  // namespace curvecast
