#include "core/density/fixed_density.h"

namespace curvecast {

absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms) {
  if (absl::Status status = check_density(terms); !status.ok()) return status;
  if (!has_fixed_terms(terms)) return nullptr;
  auto fixed = std::make_shared<FixedDensity>();
  fixed->density.resize(curve.size());
  evaluate_fixed_terms(curve, terms, std::span<float>(fixed->density));
  fixed->mass = block_mass(fixed->density, curve.area);
  return fixed;
}

}  // namespace curvecast
