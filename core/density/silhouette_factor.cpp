#include "core/density/silhouette_factor.h"

#include <cmath>
#include <limits>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kSlack = 1e-6f;

}  // namespace

SilhouetteFactor::SilhouetteFactor(const CameraFrame& frame, const ViewTerm& term)
    : x_(frame.x),
      y_(frame.y),
      z_(frame.z),
      slope_(frame.slope),
      s0_(static_cast<float>(term.s0)),
      blur_(frame.is_orthographic ? 0 : frame.blur) {}

CURVECAST_WIDE void SilhouetteFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  const float *x = vertices.x, *y = vertices.y, *z = vertices.z;
  const Snorm16 *nx = vertices.nx, *ny = vertices.ny, *nz = vertices.nz;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, s0 = s0_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float square = dx * dx + dy * dy + dz * dz;
    const float facing = dx * nx[i] + dy * ny[i] + dz * nz[i];
    const float cosine = facing / std::sqrt(square > kLeastSquare ? square : kLeastSquare);
    factor[i] *= facing > 0 ? (1 - (cosine < 1 ? cosine : 1.0f)) + s0 : 0.0f;
  }
}

CURVECAST_WIDE void SilhouetteFactor::multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor,
                                                      float* __restrict change) const {
  const float *x = blocks.x, *y = blocks.y, *z = blocks.z, *radius = blocks.radius;
  const float *nx = blocks.nx, *ny = blocks.ny, *nz = blocks.nz, *spread = blocks.spread;
  const float ex = x_, ey = y_, ez = z_, slope = slope_, s0 = s0_, blur = blur_;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = ex - slope * x[i], dy = ey - slope * y[i], dz = ez - slope * z[i];
    const float square = dx * dx + dy * dy + dz * dz;
    const float inverse = 1 / std::sqrt(square > kLeastSquare ? square : kLeastSquare);
    const float cosine = (dx * nx[i] + dy * ny[i] + dz * nz[i]) * inverse;
    // Directions to the eye differ by an angle whose sine is at most this; up to 0.5 the angle is at most 1.05 times as much.
    const float sine = (slope * radius[i] + blur) * inverse;
    const float most = spread[i] + (sine < 0.5f ? 1.05f * sine : 2.0f) + kCosineBlur;  // difference of the cosine
    const float value = 1 - (cosine < 1 ? cosine : 1.0f) + s0;
    const bool is_seen = cosine > most && spread[i] < kSmoothSpread, is_hidden = cosine < -most;
    factor[i] *= is_hidden ? 0.0f : is_seen ? value : 1 + s0;
    change[i] = (1 + change[i]) * (is_hidden ? 1.0f : is_seen ? 1 + most / value + kSlack : kInfinity) - 1;
  }
}

}  // namespace curvecast
