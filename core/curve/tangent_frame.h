// Directions without a sign on a surface (principal directions) as one 16-bit angle in a frame that the normal gives. Source of
// the frame: Duff et al., "Building an orthonormal basis, revisited" (2017).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/vec.h"

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

/// Code of the axis at angle t from `first`, from a positive multiple of (cos 2 t, sin 2 t): doubled, an axis has one angle, not
/// two. A half turn has 65536 codes; 0 where both are 0. Only additions, products and one quotient: the same everywhere.
inline std::uint16_t pack_axis(float cosine2, float sine2) {
  const float c = std::abs(cosine2), s = std::abs(sine2);
  const float larger = std::max(c, s);
  if (!(larger > 0)) return 0;
  const float x = std::min(c, s) / larger, y = x * x;
  // The arc tangent on [0, 1] within 2e-6.
  const float arc =
      x * (0.99997726f + y * (-0.33262347f + y * (0.19354346f + y * (-0.11643287f + y * (0.05265332f - y * 0.01172120f)))));
  constexpr float kCodes = 32768 / std::numbers::pi_v<float>;  // for each radian of the doubled angle
  float code = kCodes * arc;
  if (s > c) code = 16384 - code;
  if (cosine2 < 0) code = 32768 - code;
  if (sine2 < 0) code = -code;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(code + 65536.5f));
}

/// Of a direction near the tangent plane, of any length and sign.
inline std::uint16_t pack_direction(const Vec3f& direction, const Vec3f& normal) {
  const TangentFrame frame = tangent_frame(normal);
  const float p = direction.dot(frame.first), q = direction.dot(frame.second);
  return pack_axis(p * p - q * q, 2 * p * q);
}

/// A unit vector in the tangent plane, in one of its two senses.
inline Vec3f unpack_direction(std::uint16_t code, const Vec3f& normal) {
  const TangentFrame frame = tangent_frame(normal);
  const float angle = static_cast<float>(code) * (std::numbers::pi_v<float> / 65536);
  return (std::cos(angle) * frame.first + std::sin(angle) * frame.second).normalized();
}

/// Code of the mean of axes near the tangent plane of `normal`, each with its weight: the same whichever way each of them points.
inline std::uint16_t mix_directions(std::span<const Vec3f, 3> directions, const Vec3f& weights, const Vec3f& normal) {
  const TangentFrame frame = tangent_frame(normal);
  float cosine2 = 0, sine2 = 0;
  for (int i = 0; i < 3; ++i) {
    const float p = directions[i].dot(frame.first), q = directions[i].dot(frame.second);
    cosine2 += weights[i] * (p * p - q * q);
    sine2 += weights[i] * (2 * p * q);
  }
  return pack_axis(cosine2, sine2);
}

}  // namespace curvecast
