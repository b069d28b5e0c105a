#include "core/density/view_factor.h"

#include <cmath>
#include <limits>
#include <variant>

#include "core/lanes.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLeastSquare = 1e-37f;

}  // namespace

ViewFactor::ViewFactor(const SurfaceCurve& curve, std::span<const DensityTerm> terms) {
  // In units of the diagonal, and no farther out than where rays are parallel: squares fit a float at every size.
  constexpr double kFar = 1e6;
  const double diagonal = curve.box.diagonal();
  const Vec3d center = curve.box.center();
  for (const DensityTerm& any : terms) {
    const auto* const term = std::get_if<ViewTerm>(&any);
    if (term == nullptr) continue;
    Vec3d from_center = term->eye / diagonal - center / diagonal;
    if (const double reach = from_center.cwiseAbs().maxCoeff(); reach > kFar) {
      from_center = (term->eye - center) / (term->eye - center).cwiseAbs().maxCoeff() * kFar;
    }
    const Vec3f eye = (from_center + (center - curve.origin) / diagonal).cast<float>();
    eyes_.push_back({eye.x(), eye.y(), eye.z(), static_cast<float>(1 / diagonal), static_cast<float>(term->s0)});
  }
}

CURVECAST_WIDE void ViewFactor::multiply(const float* x, const float* y, const float* z, const Snorm16* nx, const Snorm16* ny,
                                         const Snorm16* nz, std::size_t n, float* factor) const {
  for (const Eye& eye : eyes_) {
    for (std::size_t i = 0; i < n; ++i) {
      const float dx = eye.x - eye.scale * x[i], dy = eye.y - eye.scale * y[i], dz = eye.z - eye.scale * z[i];
      const float square = dx * dx + dy * dy + dz * dz;
      const float facing = dx * nx[i] + dy * ny[i] + dz * nz[i];
      const float cosine = facing / std::sqrt(square > kLeastSquare ? square : kLeastSquare);
      factor[i] *= facing > 0 ? (1 - (cosine < 1 ? cosine : 1.0f)) + eye.s0 : 0.0f;
    }
  }
}

CURVECAST_WIDE void ViewFactor::of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* __restrict factor,
                                          float* __restrict change) const {
  const std::size_t n = end - begin;
  const float *x = &blocks.x[begin], *y = &blocks.y[begin], *z = &blocks.z[begin], *radius = &blocks.radius[begin];
  const float *nx = &blocks.nx[begin], *ny = &blocks.ny[begin], *nz = &blocks.nz[begin], *spread = &blocks.spread[begin];
  for (std::size_t i = 0; i < n; ++i) factor[i] = 1;
  for (std::size_t i = 0; i < n; ++i) change[i] = 0;
  for (const Eye& eye : eyes_) {
    for (std::size_t i = 0; i < n; ++i) {
      const float dx = eye.x - eye.scale * x[i], dy = eye.y - eye.scale * y[i], dz = eye.z - eye.scale * z[i];
      const float square = dx * dx + dy * dy + dz * dz;
      const float inverse = 1 / std::sqrt(square > kLeastSquare ? square : kLeastSquare);
      const float cosine = (dx * nx[i] + dy * ny[i] + dz * nz[i]) * inverse;
      // Directions to the eye differ by an angle whose sine is at most this; up to 0.5 the angle is at most 1.05 times as much.
      const float sine = eye.scale * radius[i] * inverse;
      const float most = spread[i] + (sine < 0.5f ? 1.05f * sine : 2.0f);  // difference of the cosine
      const float value = 1 - (cosine < 1 ? cosine : 1.0f) + eye.s0;
      const bool is_seen = cosine > most, is_hidden = cosine < -most;
      factor[i] *= is_hidden ? 0.0f : is_seen ? value : 1 + eye.s0;
      change[i] += is_hidden ? 0.0f : is_seen ? most / value : kInfinity;
    }
  }
}

}  // namespace curvecast
