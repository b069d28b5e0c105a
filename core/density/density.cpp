#include "core/density/density.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/density/view_factor.h"

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

// Those of a camera are ViewFactor's.
template <typename Term>
void multiply(const SurfaceCurve&, const Term&, std::span<float>) {}

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

}  // namespace

absl::Status check_density(std::span<const DensityTerm> terms) {
  for (const DensityTerm& term : terms) {
    if (absl::Status status = std::visit([](const auto& t) { return check(t); }, term); !status.ok()) return status;
  }
  return absl::OkStatus();
}

bool has_fixed_terms(std::span<const DensityTerm> terms) {
  return std::any_of(terms.begin(), terms.end(), [](const DensityTerm& t) { return std::holds_alternative<CurvatureTerm>(t); });
}

void evaluate_fixed_terms(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density) {
  std::fill(density.begin(), density.end(), 1.0f);
  for (const DensityTerm& term : terms) std::visit([&](const auto& t) { multiply(curve, t, density); }, term);
}

absl::Status evaluate_density(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density) {
  if (absl::Status status = check_density(terms); !status.ok()) return status;
  evaluate_fixed_terms(curve, terms, density);
  ViewFactor(curve, terms)
      .multiply(curve.x.data(), curve.y.data(), curve.z.data(), curve.nx.data(), curve.ny.data(), curve.nz.data(), density.size(),
                density.data());
  return absl::OkStatus();
}

}  // namespace curvecast
