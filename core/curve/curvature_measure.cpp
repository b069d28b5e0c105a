#include "core/curve/curvature_measure.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <bit>
#include <vector>

#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

constexpr double kStrongShare = 0.05;  // of the area
// Below this, in 1/diagonal (or its square), curvature is rounding noise.
constexpr double kFlat = 1e-4;

// A histogram over the upper bits of floats, which grow as the floats do: 32 bins an octave, so 3 % wide at most.
constexpr int kDroppedBits = 18;
constexpr std::size_t kBins = 1u << (31 - kDroppedBits);

std::size_t bin_of(float k) { return std::bit_cast<std::uint32_t>(k) >> kDroppedBits; }

double middle_of(std::size_t bin) {
  const auto bits = static_cast<std::uint32_t>(bin) << kDroppedBits | 1u << (kDroppedBits - 1);
  return std::bit_cast<float>(bits);
}

using Histograms = std::array<std::vector<double>, kCurvatureKinds>;

Histograms measure(const SurfaceCurve& curve) {
  const auto add = [&](const tbb::blocked_range<std::size_t>& range, Histograms area) {
    for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
      area[kind].resize(kBins, 0.0);
      for (std::size_t l = range.begin(); l < range.end(); ++l) {
        const float k = curvature_measure(static_cast<CurvatureKind>(kind), curve.curvature_min[l], curve.curvature_max[l]);
        area[kind][bin_of(k)] += curve.area[l];
      }
    }
    return area;
  };
  const auto sum = [](Histograms a, const Histograms& b) {
    for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
      a[kind].resize(kBins, 0.0);
      for (std::size_t bin = 0; bin < b[kind].size(); ++bin) a[kind][bin] += b[kind][bin];
    }
    return a;
  };
  constexpr std::size_t kGrain = 262'144;  // an addition of histograms costs less than filling them
  return tbb::parallel_deterministic_reduce(tbb::blocked_range<std::size_t>(0, curve.size(), kGrain), Histograms{}, add, sum);
}

float reference_curvature(const SurfaceCurve& curve, CurvatureKind kind, const std::vector<double>& area) {
  const double diagonal = curve.box.diagonal();
  const double scale = kind == CurvatureKind::kGauss ? diagonal * diagonal : diagonal;
  double above = 0;
  for (std::size_t bin = area.size(); bin-- > 0;) {
    above += area[bin];
    if (above < kStrongShare * curve.total_area) continue;
    const double k = middle_of(bin);
    return bin > 0 && k * scale > kFlat ? static_cast<float>(k) : 0.0f;
  }
  return 0;
}

}  // namespace

std::array<float, kCurvatureKinds> reference_curvatures(const SurfaceCurve& curve) {
  const Histograms area = measure(curve);
  std::array<float, kCurvatureKinds> reference{};
  for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
    reference[kind] = reference_curvature(curve, static_cast<CurvatureKind>(kind), area[kind]);
  }
  return reference;
}

}  // namespace curvecast
