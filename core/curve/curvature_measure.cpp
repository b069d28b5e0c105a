#include "core/curve/curvature_measure.h"

#include <algorithm>
#include <vector>

#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

constexpr double kStrongShare = 0.05;  // of the area
// Below this, in 1/diagonal (or its square), curvature is rounding noise.
constexpr double kFlat = 1e-4;

float reference_curvature(const SurfaceCurve& curve, CurvatureKind kind) {
  // A histogram over the logarithm, fine enough for 2 %.
  constexpr double kSmallest = -60;  // log2
  constexpr int kBinsPerOctave = 32;
  constexpr int kBins = 120 * kBinsPerOctave;
  std::vector<double> area(kBins, 0.0);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const float k = curvature_measure(kind, curve.curvature_min[l], curve.curvature_max[l]);
    if (!(k > 0)) continue;
    const int bin = static_cast<int>((std::log2(static_cast<double>(k)) - kSmallest) * kBinsPerOctave);
    area[std::clamp(bin, 0, kBins - 1)] += curve.area[l];
  }
  double above = 0;
  for (int bin = kBins - 1; bin >= 0; --bin) {
    above += area[bin];
    if (above < kStrongShare * curve.total_area) continue;
    const double k = std::exp2(kSmallest + (bin + 0.5) / kBinsPerOctave);
    const double diagonal = curve.box.diagonal();
    const double scale = kind == CurvatureKind::kGauss ? diagonal * diagonal : diagonal;
    return k * scale > kFlat ? static_cast<float>(k) : 0.0f;
  }
  return 0;
}

}  // namespace

std::array<float, kCurvatureKinds> reference_curvatures(const SurfaceCurve& curve) {
  return {reference_curvature(curve, CurvatureKind::kGauss), reference_curvature(curve, CurvatureKind::kMean),
          reference_curvature(curve, CurvatureKind::kMax)};
}

}  // namespace curvecast
