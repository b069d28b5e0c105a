#include "core/density/picture_detail.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace curvecast {
namespace {

/// The largest difference of a channel, of 1.
float difference(const Rgba8& a, const Rgba8& b) {
  return static_cast<float>(std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)})) / 255;
}

}  // namespace

PictureDetail::PictureDetail(const SurfaceCurve& curve)
    : curve_(curve),
      change_scale_(static_cast<float>(curve.box.diagonal() / kStrongChange)),
      has_colour_(!curve.colour.empty() && curve.size() > 1) {
  const float strong_bend = curve.reference_curvature[static_cast<std::size_t>(CurvatureKind::kMax)];
  bend_scale_ = strong_bend > 0 ? 1 / strong_bend : 0;
}

/// Change of colour from one vertex of the curve to the next, in 1/unit. 0 where they are two places with one position.
float PictureDetail::change(std::size_t l) const {
  const float distance = (curve_.position(l + 1) - curve_.position(l)).norm();
  return distance > 0 ? difference(curve_.colour[l], curve_.colour[l + 1]) / distance : 0;
}

float PictureDetail::at(std::size_t l) const {
  if (is_one()) return 1;
  float detail = bend_scale_ * curvature_measure(CurvatureKind::kMax, curve_.curvature_min[l], curve_.curvature_max[l]);
  if (has_colour_ && l > 0) detail = std::max(detail, change_scale_ * change(l - 1));
  if (has_colour_ && l + 1 < curve_.size()) detail = std::max(detail, change_scale_ * change(l));
  return kLeastDetail + (1 - kLeastDetail) * std::min(detail, 1.0f);
}

void multiply_picture_detail(const SurfaceCurve& curve, std::span<float> density) {
  const PictureDetail detail(curve);
  if (detail.is_one()) return;
  for (std::size_t l = 0; l < density.size(); ++l) density[l] *= detail.at(l);
}

}  // namespace curvecast
