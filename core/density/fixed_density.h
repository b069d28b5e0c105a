// What the terms that are the same for all cameras make of a curve. It costs more than a frame and outlives the view.
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
  Column<float> density;  // L: the terms' product
  Column<float> most;     // B: the largest in each block
  BlockMass mass;         // of density times area

  std::size_t byte_size() const { return (density.size() + most.size()) * sizeof(float) + mass.byte_size(); }
};

/// Of the fixed ones among the terms; null where there are none, as then it is 1 everywhere. Errors as of
/// evaluate_fixed_terms(). Precondition: check_density() finds nothing.
absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms);

}  // namespace curvecast
