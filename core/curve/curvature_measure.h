// Scalar measures of curvature, and the value that counts as strong on a given surface.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace curvecast {

struct SurfaceCurve;

enum class CurvatureKind : std::uint8_t { kGauss, kMean, kMax };  // |k1 k2|, |k1 + k2| / 2, max(|k1|, |k2|)
inline constexpr int kCurvatureKinds = 3;

/// k1, k2: principal curvatures in 1/unit. Gauss is in 1/unit^2.
inline float curvature_measure(CurvatureKind kind, float k1, float k2) {
  switch (kind) {
    case CurvatureKind::kGauss:
      return std::abs(k1 * k2);
    case CurvatureKind::kMean:
      return 0.5f * std::abs(k1 + k2);
    case CurvatureKind::kMax:
      break;
  }
  return std::fmax(std::abs(k1), std::abs(k2));
}

/// Returns for each kind the measure that only a twentieth of the surface's area exceeds, within 2 %; 0 on surfaces that are flat
/// but for noise (in that measure).
std::array<float, kCurvatureKinds> reference_curvatures(const SurfaceCurve& curve);

}  // namespace curvecast
