#include "core/density/density.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/density/expression.h"
#include "core/density/fixed_terms.h"
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
  if (!(term.s0 > 0 && term.s0 <= kMaxS0)) {
    return absl::InvalidArgumentError(absl::StrFormat("view density: s0 = %g; it must lie in (0, %g]", term.s0, kMaxS0));
  }
  return absl::OkStatus();
}

absl::Status check(const DistanceTerm& term) {
  if (!(term.near >= 0 && std::isfinite(term.near))) {
    return absl::InvalidArgumentError(
        absl::StrFormat("distance density: near = %g; it must be 0 or more, and finite", term.near));
  }
  if (!(term.far > 0 && term.far >= term.near)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("distance density: far = %g; it must be above 0 and not less than near, %g", term.far, term.near));
  }
  if (term.fall == DistanceFall::kLinear && !std::isfinite(term.far)) {
    return absl::InvalidArgumentError("distance density: a linear fall needs a far, where no points are left");
  }
  return absl::OkStatus();
}

absl::Status check(const FrustumTerm&) { return absl::OkStatus(); }
absl::Status check(const ScreenTerm&) { return absl::OkStatus(); }
absl::Status check(const PictureTerm&) { return absl::OkStatus(); }

absl::Status check(const AttributeTerm& term) {
  return term.name.empty() ? absl::InvalidArgumentError("attribute density: the name is empty") : absl::OkStatus();
}

absl::Status check(const Dab& dab) {
  if (!dab.centre.allFinite()) return absl::InvalidArgumentError("brush density: the centre's coordinates are not finite");
  if (!(dab.radius > 0 && std::isfinite(dab.radius))) {
    return absl::InvalidArgumentError(absl::StrFormat("brush density: radius = %g; it must be above 0, and finite", dab.radius));
  }
  if (!(dab.factor >= 0 && dab.factor <= kMaxBrushFactor)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("brush density: factor = %g; it must lie in [0, %g]", dab.factor, kMaxBrushFactor));
  }
  if (!(dab.falloff >= 0 && dab.falloff <= 1)) {
    return absl::InvalidArgumentError(absl::StrFormat("brush density: falloff = %g; it must lie in [0, 1]", dab.falloff));
  }
  return absl::OkStatus();
}

absl::Status check(const BrushTerm& term) {
  for (const Dab& dab : term.dabs) {
    if (absl::Status status = check(dab); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status check(const ExpressionTerm& term) { return check_expression(term.text); }

}  // namespace

bool is_camera_term(const DensityTerm& term) {
  return std::holds_alternative<ViewTerm>(term) || std::holds_alternative<DistanceTerm>(term) ||
         std::holds_alternative<FrustumTerm>(term) || std::holds_alternative<ScreenTerm>(term) ||
         std::holds_alternative<PictureTerm>(term);
}

bool is_fixed_term(const DensityTerm& term) {
  return std::holds_alternative<PictureTerm>(term) || (!is_camera_term(term) && !std::holds_alternative<UniformTerm>(term));
}

absl::Status check_density(const Density& density) {
  for (const DensityTerm& term : density.terms) {
    if (absl::Status status = std::visit([](const auto& t) { return check(t); }, term); !status.ok()) return status;
  }
  if (density.cameras.size() > kMaxCameras) {
    return absl::InvalidArgumentError(
        absl::StrCat("the density has ", density.cameras.size(), " cameras; at most ", kMaxCameras, " are taken"));
  }
  for (std::size_t i = 0; i < density.cameras.size(); ++i) {
    if (const absl::Status status = check_camera(density.cameras[i]); !status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("camera ", i, " of the density: ", status.message()));
    }
  }
  if (density.cameras.empty() && std::any_of(density.terms.begin(), density.terms.end(), is_camera_term)) {
    return absl::InvalidArgumentError("view, distance, frustum, screen and picture densities need a camera");
  }
  return absl::OkStatus();
}

bool has_fixed_terms(std::span<const DensityTerm> terms) { return std::any_of(terms.begin(), terms.end(), is_fixed_term); }

absl::Status evaluate_fixed_terms(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density,
                                  const ExecutionContext& context) {
  std::fill(density.begin(), density.end(), 1.0f);
  for (const DensityTerm& term : terms) {
    if (absl::Status status = multiply_fixed_term(curve, term, density, context); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status evaluate_density(const SurfaceCurve& curve, const Density& density, std::span<float> values,
                              const ExecutionContext& context) {
  if (absl::Status status = check_density(density); !status.ok()) return status;
  if (absl::Status status = evaluate_fixed_terms(curve, density.terms, values, context); !status.ok()) return status;
  ViewFactor(curve, density).multiply(VertexColumns::of(curve), values.size(), values.data());
  return absl::OkStatus();
}

}  // namespace curvecast
