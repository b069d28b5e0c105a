// What cameras make of a density: the terms that change with every view, for single curve vertices and for whole blocks of them
// (paper, section 4.3).
#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/density/distance_factor.h"
#include "core/density/frustum_factor.h"
#include "core/density/screen_factor.h"
#include "core/density/silhouette_factor.h"

namespace curvecast {

class ViewFactor {
 public:
  /// The camera terms of a density, on curves with the box and origin of this one. Precondition: check_density() finds nothing.
  ViewFactor(const SurfaceCurve& curve, const Density& density);

  /// Whether there are none, and so all factors 1.
  bool is_one() const { return cameras_.empty(); }

  /// Multiplies factor[i] by that of place i of n: the largest of the cameras'.
  void multiply(const float* x, const float* y, const float* z, const Snorm16* nx, const Snorm16* ny, const Snorm16* nz,
                std::size_t n, float* factor) const;

  /// Writes to `factor` that of the middle of the blocks [begin, end), and to `change` how much more or less it is at most,
  /// relative to that, on a vertex of the block; infinite where that is not known, as where the surface's outline may pass
  /// through the block. Where no vertex is seen the factor is 0, and `change` means nothing.
  void of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* __restrict factor,
                 float* __restrict change) const;

  /// Writes to `most` what the factor is at most on a vertex of the blocks [begin, end), but for rounding.
  void most_of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* most) const;

  /// Pixels per squared unit of the file that a screen term of 1 stands for.
  double pixels() const { return pixels_; }

 private:
  using Factor = std::variant<SilhouetteFactor, DistanceFactor, FrustumFactor, ScreenFactor>;

  std::vector<std::vector<Factor>> cameras_;
  double pixels_ = 0;
};

}  // namespace curvecast
