#include "core/curve/curvature_measure.h"

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

/// `area`: by bins.
float strong_measure(CurvatureKind kind, const std::vector<double>& area, double diagonal, double total_area) {
  const double scale = kind == CurvatureKind::kGauss ? diagonal * diagonal : diagonal;
  double above = 0;
  for (std::size_t bin = area.size(); bin-- > 0;) {
    above += area[bin];
    if (above < kStrongShare * total_area) continue;
    const double k = middle_of(bin);
    return bin > 0 && k * scale > kFlat ? static_cast<float>(k) : 0.0f;
  }
  return 0;
}

}  // namespace

void CurvatureHistogram::add(float k1, float k2, double area) {
  for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
    if (area_[kind].empty()) area_[kind].resize(kBins, 0.0);
    area_[kind][bin_of(curvature_measure(static_cast<CurvatureKind>(kind), k1, k2))] += area;
  }
}

void CurvatureHistogram::add(const CurvatureHistogram& other) {
  for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
    if (area_[kind].empty()) area_[kind].resize(kBins, 0.0);
    for (std::size_t bin = 0; bin < other.area_[kind].size(); ++bin) area_[kind][bin] += other.area_[kind][bin];
  }
}

std::array<float, kCurvatureKinds> CurvatureHistogram::strong(double diagonal, double total_area) const {
  std::array<float, kCurvatureKinds> measures{};
  for (std::size_t kind = 0; kind < kCurvatureKinds; ++kind) {
    measures[kind] = strong_measure(static_cast<CurvatureKind>(kind), area_[kind], diagonal, total_area);
  }
  return measures;
}

std::array<float, kCurvatureKinds> reference_curvatures(const SurfaceCurve& curve) {
  const CurvatureHistogram histogram = curvature_histogram(curve.size(), {}, [&](std::size_t l, CurvatureHistogram& into) {
    into.add(curve.curvature_min[l], curve.curvature_max[l], curve.area[l]);
  });
  return histogram.strong(curve.box.diagonal(), curve.total_area);
}

}  // namespace curvecast
