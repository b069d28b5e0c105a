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
  // Where there is one brush among the terms: its paint (L), before it is scaled, and the product of the others; null is 1.
  Column<float> paint;
  std::shared_ptr<const FixedDensity> others;

  std::size_t byte_size() const {
    return (density.size() + most.size() + paint.size()) * sizeof(float) + mass.byte_size() + (others ? others->byte_size() : 0);
  }
};

/// A density of the same terms, but only the first of the brush's dabs.
struct EarlierPaint {
  std::shared_ptr<const FixedDensity> fixed;
  std::size_t dabs = 0;
};

/// Multiplies the fixed ones among the terms. Returns null where there are none: the density is 1 everywhere. `earlier`: what
/// there is by now; it makes no difference but of time. Errors as of evaluate_fixed_terms(). Precondition: check_density() finds
/// nothing.
absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms,
                                                                       const EarlierPaint& earlier = {},
                                                                       const ExecutionContext& context = {});

/// Returns the brush among the terms; null where there is none, or several.
const BrushTerm* only_brush(std::span<const DensityTerm> terms);

}  // namespace curvecast
