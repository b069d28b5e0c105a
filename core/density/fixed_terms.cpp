#include "core/density/fixed_terms.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/density/brush.h"
#include "core/density/expression.h"
#include "core/density/picture_detail.h"

namespace curvecast {
namespace {

/// Multiplies by what `values` holds where that is a positive number, else by 0.
absl::Status multiply_values(const SurfaceCurve& curve, const std::string& what, std::span<const float> values,
                             std::span<float> density) {
  float largest = 0;
  for (std::size_t l = 0; l < values.size(); ++l) {
    if (std::isinf(values[l])) {
      const Vec3d place = curve.origin + curve.position(l).cast<double>();
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: the value is infinite at %.9g, %.9g, %.9g", what, place.x(), place.y(), place.z()));
    }
    largest = values[l] > largest ? values[l] : largest;
  }
  const double scale = largest > 0 ? 1 / static_cast<double>(largest) : 0;
  for (std::size_t l = 0; l < values.size(); ++l) {
    density[l] *= values[l] > 0 ? static_cast<float>(scale * static_cast<double>(values[l])) : 0.0f;
  }
  return absl::OkStatus();
}

// Those without a place among the fixed ones: uniform, and those of a camera.
template <typename Term>
absl::Status multiply(const SurfaceCurve&, const Term&, std::span<float>, const ExecutionContext&) {
  return absl::OkStatus();
}

absl::Status multiply(const SurfaceCurve& curve, const CurvatureTerm& term, std::span<float> density, const ExecutionContext&) {
  const float reference = curve.reference_curvature[static_cast<std::size_t>(term.kind)];
  if (!(reference > 0)) return absl::OkStatus();
  const float scale = 1 / reference;
  const auto floor = static_cast<float>(term.floor);
  const auto exponent = static_cast<float>(term.exponent);
  for (std::size_t l = 0; l < density.size(); ++l) {
    const float k = curvature_measure(term.kind, curve.curvature_min[l], curve.curvature_max[l]);
    const float value = floor + (1 - floor) * std::min(scale * k, 1.0f);
    density[l] *= exponent == 1 ? value : std::pow(value, exponent);
  }
  return absl::OkStatus();
}

absl::Status multiply(const SurfaceCurve& curve, const PictureTerm&, std::span<float> density, const ExecutionContext&) {
  multiply_picture_detail(curve, density);
  return absl::OkStatus();
}

absl::Status multiply(const SurfaceCurve& curve, const AttributeTerm& term, std::span<float> density, const ExecutionContext&) {
  std::string known;
  for (const ScalarColumn& scalar : curve.scalars) {
    if (scalar.name == term.name) {
      return multiply_values(curve, absl::StrCat("attribute density '", term.name, "'"), scalar.values, density);
    }
    absl::StrAppend(&known, known.empty() ? "" : ", ", scalar.name);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("attribute density: the mesh has no attribute '", term.name, "'; ",
                   known.empty() ? "it has none with one number for each vertex" : absl::StrCat("there are: ", known)));
}

absl::Status multiply(const SurfaceCurve& curve, const BrushTerm& term, std::span<float> density,
                      const ExecutionContext& context) {
  std::vector<float> values(density.size(), 1.0f);
  if (absl::Status status = paint(curve, term.dabs, values, context); !status.ok()) return status;
  const float scale = paint_scale(term.dabs);
  for (std::size_t l = 0; l < density.size(); ++l) density[l] *= scale * values[l];
  return absl::OkStatus();
}

absl::Status multiply(const SurfaceCurve& curve, const ExpressionTerm& term, std::span<float> density,
                      const ExecutionContext& context) {
  std::vector<float> values(density.size());
  if (absl::Status status = evaluate_expression(curve, term.text, values, context); !status.ok()) return status;
  return multiply_values(curve, absl::StrCat("expression density '", term.text, "'"), values, density);
}

}  // namespace

absl::Status multiply_fixed_term(const SurfaceCurve& curve, const DensityTerm& term, std::span<float> density,
                                 const ExecutionContext& context) {
  return std::visit([&](const auto& t) { return multiply(curve, t, density, context); }, term);
}

}  // namespace curvecast
