// What cameras make of a density: the terms that change with every view, for single curve vertices and for whole blocks of them
// (paper, section 4.3).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"

namespace curvecast {

class ViewFactor {
 public:
  /// The view terms among `terms`, on curves with the box and origin of this one. Precondition: evaluate_density() would take
  /// them.
  ViewFactor(const SurfaceCurve& curve, std::span<const DensityTerm> terms);

  /// Whether there are none, and so all factors 1.
  bool is_one() const { return eyes_.empty(); }

  /// Multiplies factor[i] by that of place i of n.
  void multiply(const float* x, const float* y, const float* z, const Snorm16* nx, const Snorm16* ny, const Snorm16* nz,
                std::size_t n, float* factor) const;

  /// Writes to `factor` that of the middle of the blocks [begin, end), and to `change` how much more or less it is at most,
  /// relative to that, on a vertex of the block; infinite where the surface's outline may pass through the block. Where no vertex
  /// faces the eye the factor is 0.
  void of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* __restrict factor,
                 float* __restrict change) const;

 private:
  struct Eye {
    float x, y, z, scale, s0;
  };

  std::vector<Eye> eyes_;
};

}  // namespace curvecast
