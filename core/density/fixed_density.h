// The product of a density's fixed terms on a curve: the terms that are the same for all cameras. Making it costs more than a
// frame, so it is kept from view to view.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <memory>
#include <span>

#include "core/base/column.h"
#include "core/curve/curve_blocks.h"
#include "core/density/density.h"

namespace curvecast {

struct FixedDensity {
  Column<float> density;  // L: at each curve vertex
  Column<float> most;     // B: the largest density in each block
  BlockMass mass;         // density times area

  std::size_t byte_size() const { return (density.size() + most.size()) * sizeof(float) + mass.byte_size(); }
};

/// Multiplies the fixed ones among the terms. Returns null where there are none: the density is 1 everywhere. Errors as of
/// evaluate_fixed_terms(). Precondition: check_density() finds nothing.
absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms);

}  // namespace curvecast
