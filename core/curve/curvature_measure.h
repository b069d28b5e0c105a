// Scalar measures of curvature, and the value that counts as strong on a given surface.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"

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

/// Which part of a surface has which curvature.
class CurvatureHistogram {
 public:
  void add(float k1, float k2, double area);
  void add(const CurvatureHistogram& other);

  /// Returns for each kind the measure that only a twentieth of the surface's area exceeds, within 2 %; 0 on surfaces that are
  /// flat but for noise (in that measure). `diagonal`: of the surface's box; `total_area`: the surface's.
  std::array<float, kCurvatureKinds> strong(double diagonal, double total_area) const;

 private:
  std::array<std::vector<double>, kCurvatureKinds> area_;  // by bins of the measure; empty at first
};

/// The histogram to which add(i, histogram) adds each of n parts of a surface, on all threads; the same however many there are.
/// Some are missing once the context is cancelled.
template <typename Add>
CurvatureHistogram curvature_histogram(std::size_t n, const ExecutionContext& context, const Add& add) {
  constexpr std::size_t kGrain = 262'144;  // an addition of histograms costs less than filling them
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, n, kGrain), CurvatureHistogram{},
      [&](const tbb::blocked_range<std::size_t>& range, CurvatureHistogram histogram) {
        if (context.cancelled()) return histogram;
        for (std::size_t i = range.begin(); i < range.end(); ++i) add(i, histogram);
        return histogram;
      },
      [](CurvatureHistogram a, const CurvatureHistogram& b) {
        a.add(b);
        return a;
      });
}

/// What is strong on the surface of a curve.
std::array<float, kCurvatureKinds> reference_curvatures(const SurfaceCurve& curve);

}  // namespace curvecast
