#include "core/density/density.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

namespace curvecast {
namespace {

absl::Status check(const UniformTerm&) { return absl::OkStatus(); }

absl::Status check(const CurvatureTerm& term) {
  if (!(std::isfinite(term.exponent) && term.exponent >= 0)) {
    return absl::InvalidArgumentError(absl::StrFormat("curvature density: exponent = %g; it must be 0 or more", term.exponent));
  }
  if (!(term.floor >= 0 && term.floor <= 1)) {
    return absl::InvalidArgumentError(absl::StrFormat("curvature density: floor = %g; it must lie in [0, 1]", term.floor));
  }
  return absl::OkStatus();
}

absl::Status check(const ViewTerm& term) {
  if (!term.eye.allFinite()) return absl::InvalidArgumentError("view density: the eye's coordinates are not finite");
  if (!(term.s0 > 0 && term.s0 <= kMaxS0)) {
    return absl::InvalidArgumentError(absl::StrFormat("view density: s0 = %g; it must lie in (0, %g]", term.s0, kMaxS0));
  }
  return absl::OkStatus();
}

void multiply(const SurfaceCurve&, const UniformTerm&, std::span<float>) {}

void multiply(const SurfaceCurve& curve, const CurvatureTerm& term, std::span<float> density) {
  const float reference = curve.reference_curvature[static_cast<std::size_t>(term.kind)];
  if (!(reference > 0)) return;
  const float scale = 1 / reference;
  const auto floor = static_cast<float>(term.floor);
  const auto exponent = static_cast<float>(term.exponent);
  for (std::size_t l = 0; l < density.size(); ++l) {
    const float k = curvature_measure(term.kind, curve.curvature_min[l], curve.curvature_max[l]);
    const float value = floor + (1 - floor) * std::min(scale * k, 1.0f);
    density[l] *= exponent == 1 ? value : std::pow(value, exponent);
  }
}

void multiply(const SurfaceCurve& curve, const ViewTerm& term, std::span<float> density) {
  // In units of the diagonal, and no farther out than where rays are parallel: squares fit a float at every size.
  constexpr double kFar = 1e6;
  const double diagonal = curve.box.diagonal();
  const Vec3d center = curve.box.center();
  Vec3d from_center = term.eye / diagonal - center / diagonal;
  if (const double reach = from_center.cwiseAbs().maxCoeff(); reach > kFar) {
    from_center = (term.eye - center) / (term.eye - center).cwiseAbs().maxCoeff() * kFar;
  }
  const Vec3f eye = (from_center + (center - curve.origin) / diagonal).cast<float>();
  const float ex = eye.x(), ey = eye.y(), ez = eye.z();
  const auto scale = static_cast<float>(1 / diagonal);
  const auto s0 = static_cast<float>(term.s0);
  const float *x = curve.x.data(), *y = curve.y.data(), *z = curve.z.data();
  const Snorm16 *nx = curve.nx.data(), *ny = curve.ny.data(), *nz = curve.nz.data();
  float* out = density.data();
  for (std::size_t l = 0; l < density.size(); ++l) {
    const float dx = ex - scale * x[l], dy = ey - scale * y[l], dz = ez - scale * z[l];
    const float square = std::max(dx * dx + dy * dy + dz * dz, 1e-37f);
    const float facing = dx * nx[l] + dy * ny[l] + dz * nz[l];
    const float cosine = std::min(facing / std::sqrt(square), 1.0f);
    out[l] *= facing > 0 ? (1 - cosine) + s0 : 0.0f;
  }
}

}  // namespace

absl::Status evaluate_density(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density) {
  for (const DensityTerm& term : terms) {
    if (absl::Status status = std::visit([](const auto& t) { return check(t); }, term); !status.ok()) return status;
  }
  std::fill(density.begin(), density.end(), 1.0f);
  for (const DensityTerm& term : terms) std::visit([&](const auto& t) { multiply(curve, t, density); }, term);
  return absl::OkStatus();
}

}  // namespace curvecast
