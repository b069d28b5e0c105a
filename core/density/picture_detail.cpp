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

/// Change of colour from one vertex of the curve to the next, in 1/unit. 0 where they are two places with one position.
float change(const SurfaceCurve& curve, std::size_t l, std::size_t next) {
  const float distance = (curve.position(next) - curve.position(l)).norm();
  return distance > 0 ? difference(curve.colour[l], curve.colour[next]) / distance : 0;
}

}  // namespace

void multiply_picture_detail(const SurfaceCurve& curve, std::span<float> density) {
  const float strong_bend = curve.reference_curvature[static_cast<std::size_t>(CurvatureKind::kMax)];
  const float bend_scale = strong_bend > 0 ? 1 / strong_bend : 0;
  const auto change_scale = static_cast<float>(curve.box.diagonal() / kStrongChange);
  const bool has_colour = !curve.colour.empty() && curve.size() > 1;
  if (bend_scale == 0 && !has_colour) return;
  float before = 0;
  for (std::size_t l = 0; l < density.size(); ++l) {
    float detail = bend_scale * curvature_measure(CurvatureKind::kMax, curve.curvature_min[l], curve.curvature_max[l]);
    if (has_colour) {
      const float after = l + 1 < curve.size() ? change(curve, l, l + 1) : before;
      detail = std::max(detail, change_scale * std::max(before, after));
      before = after;
    }
    density[l] *= kLeastDetail + (1 - kLeastDetail) * std::min(detail, 1.0f);
  }
}

}  // namespace curvecast
