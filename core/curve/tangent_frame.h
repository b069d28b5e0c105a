// Directions without a sign on a surface (principal directions) as one 16-bit angle in a frame that the normal gives. Source of
// the frame: Duff et al., "Building an orthonormal basis, revisited" (2017).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/vec.h"

namespace curvecast {

struct TangentFrame {
  Vec3f first, second;  // right-handed with the normal
};

/// Precondition: `normal` is of length 1, at least as a packed one is. Exactly the same normal gives exactly the same frame.
inline TangentFrame tangent_frame(const Vec3f& normal) {
  const float sign = std::copysign(1.0f, normal.z());
  const float a = -1 / (sign + normal.z());
  const float b = normal.x() * normal.y() * a;
  return {{1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()},
          {b, sign + normal.y() * normal.y() * a, -normal.y()}};
}

/// Returns the code of the axis at angle t from `first`, from a positive multiple of (cos 2 t, sin 2 t): doubled, an axis has one
/// angle, not two. A half turn has 65536 codes; 0 where both are 0, some code where one is no number. Only additions,
/// products and one quotient: the same everywhere.
inline std::uint16_t pack_axis(float cosine2, float sine2) {
  // Selections, no jumps: loops over this become vector code.
  const float c = std::abs(cosine2), s = std::abs(sine2);
  const float larger = c > s ? c : s, smaller = c > s ? s : c;
  const float x = smaller / (larger > 0 ? larger : 1.0f), y = x * x;
  // The arc tangent on [0, 1] within 2e-6.
  const float arc =
      x * (0.99997726f + y * (-0.33262347f + y * (0.19354346f + y * (-0.11643287f + y * (0.05265332f - y * 0.01172120f)))));
  constexpr float kCodes = 32768 / std::numbers::pi_v<float>;  // for each radian of the doubled angle
  float code = kCodes * arc;
  code = s > c ? 16384 - code : code;
  code = cosine2 < 0 ? 32768 - code : code;
  code = sine2 < 0 ? -code : code;
  const float positive = code + 65536.5f;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(positive > 0 ? positive : 0.0f));  // of no number, 0
}

/// Returns a unit vector in the tangent plane, in one of its two senses.
inline Vec3f unpack_direction(std::uint16_t code, const Vec3f& normal) {
  const TangentFrame frame = tangent_frame(normal);
  const float angle = static_cast<float>(code) * (std::numbers::pi_v<float> / 65536);
  return (std::cos(angle) * frame.first + std::sin(angle) * frame.second).normalized();
}

/// Axes add up as tensors d d^T, whichever way each d points: xx, yy, zz, xy, yz, zx.
using AxisTensor = std::array<float, 6>;

inline AxisTensor axis_tensor(const Vec3f& d) {
  return {d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.x() * d.y(), d.y() * d.z(), d.z() * d.x()};
}

/// Returns the code of the mean axis in the tangent plane of a normal.
inline std::uint16_t pack_axes(const AxisTensor& t, float x, float y, float z) {
  // tangent_frame(), spelt out.
  const float sign = std::copysign(1.0f, z);
  const float a = -1 / (sign + z);
  const float b = x * y * a;
  const float fx = 1 + sign * x * x * a, fy = sign * b, fz = -sign * x;
  const float sx = b, sy = sign + y * y * a, sz = -y;
  const float ffx = t[0] * fx + t[3] * fy + t[5] * fz, ffy = t[3] * fx + t[1] * fy + t[4] * fz,
              ffz = t[5] * fx + t[4] * fy + t[2] * fz;
  const float ssx = t[0] * sx + t[3] * sy + t[5] * sz, ssy = t[3] * sx + t[1] * sy + t[4] * sz,
              ssz = t[5] * sx + t[4] * sy + t[2] * sz;
  const float first = ffx * fx + ffy * fy + ffz * fz, second = ssx * sx + ssy * sy + ssz * sz;
  return pack_axis(first - second, 2 * (ffx * sx + ffy * sy + ffz * sz));
}

}  // namespace curvecast
