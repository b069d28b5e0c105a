#include "core/density/picture_factor.h"

#include <cmath>

#include "core/base/simd.h"
#include "core/density/density.h"
#include "core/density/picture_detail.h"

namespace curvecast {
namespace {

constexpr float kLeastCosine = static_cast<float>(kLeastSlant);
// The factor for outlines is this, less the cosine.
constexpr float kOutline = 1 + static_cast<float>(kPictureFloor);

/// How much vertex i faces a direction (dx, dy, dz): the scalar product with its normal, or with the one beside it where it faces
/// away. Above 0 where it counts.
template <bool kBeside>
[[gnu::always_inline]] inline float facing(const VertexColumns& vertices, std::size_t i, float dx, float dy, float dz) {
  const float own = dx * vertices.nx[i] + dy * vertices.ny[i] + dz * vertices.nz[i];
  if constexpr (!kBeside) return own;
  const Direction8 n = vertices.beside[i];
  const float beside = (dx * n.x() + dy * n.y() + dz * n.z()) * (1 / Direction8::kOne);
  return own > 0 ? own : beside;
}

/// How far a place lies within all sides.
[[gnu::always_inline]] inline float least(const std::array<AffineForm, 5>& sides, float x, float y, float z) {
  const float upright = fast_min(sides[0].at(x, y, z), sides[1].at(x, y, z));
  const float across = fast_min(sides[2].at(x, y, z), sides[3].at(x, y, z));
  return fast_min(fast_min(upright, across), sides[4].at(x, y, z));
}

}  // namespace

PictureFactor::PictureFactor(const CameraFrame& frame, const CameraFrame& wider, float weight)
    : screen_(frame, weight),
      silhouette_(frame, {.s0 = kPictureFloor}),
      frustum_(wider),
      x_(frame.x),
      y_(frame.y),
      z_(frame.z),
      slope_(frame.slope),
      blur_(frame.is_orthographic ? 0 : frame.blur),
      depth_(frame.depth),
      depth_reach_(frame.depth_reach),
      weight_(weight),
      sides_(wider.sides),
      scale_(static_cast<float>(wider.scale)),
      side_blur_(wider.blur) {}

template <bool kBeside>
[[gnu::always_inline]] inline void PictureFactor::multiply_each(const VertexColumns& vertices, std::size_t n,
                                                                float* factor) const {
  const VertexColumns v = vertices;
  const PictureFactor own = *this;  // which no store to `factor` changes
  for (std::size_t i = 0; i < n; ++i) {
    const float x = v.x[i], y = v.y[i], z = v.z[i];
    const float dx = own.x_ - own.slope_ * x, dy = own.y_ - own.slope_ * y, dz = own.z_ - own.slope_ * z;
    const float square = dx * dx + dy * dy + dz * dz;
    const float towards = facing<kBeside>(v, i, dx, dy, dz);
    const float distance = std::sqrt(square > kLeastSquare ? square : kLeastSquare);
    const float depth = own.depth_.at(x, y, z);
    const float cosine = fast_min(towards / distance, 1.0f);
    const float pixels = fast_min(pixels_on_screen(own.weight_, fast_max(cosine, kLeastCosine), distance, depth), kMostOnScreen);
    const bool is_seen = fast_min(towards, depth) > 0 && least(own.sides_, x, y, z) >= 0;
    factor[i] *= is_seen ? pixels * (kOutline - cosine) : 0.0f;
  }
}

CURVECAST_WIDE void PictureFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  if (vertices.beside != nullptr) return multiply_beside(vertices, n, factor);
  multiply_each<false>(vertices, n, factor);
}

CURVECAST_WIDE void PictureFactor::multiply_beside(const VertexColumns& vertices, std::size_t n, float* factor) const {
  multiply_each<true>(vertices, n, factor);
}

void PictureFactor::multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor,
                                    float* __restrict change) const {
  screen_.multiply_blocks(blocks, n, factor, change);
  silhouette_.multiply_blocks(blocks, n, factor, change);
  frustum_.multiply_blocks(blocks, n, factor, change);
}

CURVECAST_WIDE void PictureFactor::multiply_most(const BlockColumns& blocks, std::size_t n, float* __restrict most) const {
  const BlockColumns b = blocks;
  const PictureFactor own = *this;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = b.x[i], y = b.y[i], z = b.z[i], radius = b.radius[i];
    const float dx = own.x_ - own.slope_ * x, dy = own.y_ - own.slope_ * y, dz = own.z_ - own.slope_ * z;
    const float square = dx * dx + dy * dy + dz * dz;
    const float distance = std::sqrt(square > kLeastSquare ? square : kLeastSquare), inverse = 1 / distance;
    const float cosine = (dx * b.nx[i] + dy * b.ny[i] + dz * b.nz[i]) * inverse;
    const float reach = own.slope_ * radius + own.blur_;
    const float sine = reach * inverse;  // as in SilhouetteFactor
    const float off = b.spread[i] + (sine < 0.5f ? 1.05f * sine : 2.0f) + kCosineBlur;
    const float low = fast_max(cosine - off, 0.0f), high = fast_min(cosine + off, 1.0f);
    const float depth = own.depth_.at(x, y, z), deep = own.depth_reach_ * radius + own.blur_;
    // Of cosine (kOutline - cosine), which is largest at half of kOutline.
    const float worst = fast_min(fast_max(0.5f * kOutline, low), high);
    const float shape = fast_max(worst * (kOutline - worst), kLeastCosine * (kOutline - low));
    const float pixels = pixels_on_screen(own.weight_, shape, distance + reach, depth - deep);
    const bool is_hidden = cosine < -off || depth < -deep || least(own.sides_, x, y, z) < -(own.scale_ * radius + own.side_blur_);
    most[i] *= is_hidden ? 0.0f : fast_min(pixels, kMostOnScreen * (kOutline - low));
  }
}

}  // namespace curvecast
