// Density terms and their product, evaluated on the curve (paper, sections 3.4 and 4.3).
#pragma once

#include <absl/status/status.h>

#include <span>
#include <variant>

#include "core/curve/surface_curve.h"
#include "core/vec.h"

namespace curvecast {

struct UniformTerm {
  bool operator==(const UniformTerm&) const = default;
};

/// (floor + (1 - floor) min(|k| / k_ref, 1))^exponent, where k_ref is the curve's reference_curvature: only a twentieth of
/// the area is curved more. 1 everywhere on a flat surface.
struct CurvatureTerm {
  CurvatureKind kind = CurvatureKind::kGauss;
  double exponent = 1;  // >= 0
  double floor = 0.05;  // in [0, 1], relative to k_ref: flat regions keep this density

  bool operator==(const CurvatureTerm&) const = default;
};

inline constexpr double kMaxS0 = 1e6;

/// Silhouette enhancement: with c the cosine between normal and direction to the eye, 1 - c + s0 where c > 0, else 0.
struct ViewTerm {
  Vec3d eye = Vec3d::Zero();  // absolute coordinates, in the file's units
  double s0 = 0.1;            // in (0, kMaxS0]: density of what faces the eye squarely

  bool operator==(const ViewTerm&) const = default;
};

using DensityTerm = std::variant<UniformTerm, CurvatureTerm, ViewTerm>;

/// InvalidArgument names the term and field that is out of range or not finite.
absl::Status check_density(std::span<const DensityTerm> terms);

/// Whether any term differs over the surface and is the same for all cameras.
bool has_fixed_terms(std::span<const DensityTerm> terms);

/// Writes the product of those at every curve vertex (L entries). Precondition: check_density() finds nothing.
void evaluate_fixed_terms(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density);

/// Writes the product of the terms at every curve vertex to `density` (L entries, relative values: only ratios matter).
/// No terms mean uniform. Errors as of check_density().
absl::Status evaluate_density(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density);

}  // namespace curvecast
