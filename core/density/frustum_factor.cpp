#include "core/density/frustum_factor.h"

#include <limits>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

CURVECAST_WIDE void FrustumFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  const float *x = vertices.x, *y = vertices.y, *z = vertices.z;
  const auto [a, b, c, d, e] = sides_;
  for (std::size_t i = 0; i < n; ++i) {
    const float upright = fast_min(a.at(x[i], y[i], z[i]), b.at(x[i], y[i], z[i]));
    const float across = fast_min(c.at(x[i], y[i], z[i]), d.at(x[i], y[i], z[i]));
    factor[i] *= fast_min(fast_min(upright, across), e.at(x[i], y[i], z[i])) >= 0 ? 1.0f : 0.0f;
  }
}

CURVECAST_WIDE void FrustumFactor::multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor,
                                                   float* __restrict change) const {
  const float *x = blocks.x, *y = blocks.y, *z = blocks.z, *radius = blocks.radius;
  const auto [a, b, c, d, e] = sides_;
  const float scale = scale_, blur = blur_;
  for (std::size_t i = 0; i < n; ++i) {
    const float upright = fast_min(a.at(x[i], y[i], z[i]), b.at(x[i], y[i], z[i]));
    const float across = fast_min(c.at(x[i], y[i], z[i]), d.at(x[i], y[i], z[i]));
    const float inside = fast_min(fast_min(upright, across), e.at(x[i], y[i], z[i]));
    const float reach = scale * radius[i] + blur;
    factor[i] *= inside < -reach ? 0.0f : 1.0f;
    change[i] = (1 + change[i]) * (inside < -reach || inside > reach ? 1.0f : kInfinity) - 1;
  }
}

}  // namespace curvecast
