// The factor of a density that depends on cameras, for single curve vertices and for whole blocks of them (paper, section 4.3).
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/camera_frame.h"
#include "core/density/density.h"
#include "core/density/distance_factor.h"
#include "core/density/frustum_factor.h"
#include "core/density/picture_factor.h"
#include "core/density/screen_factor.h"
#include "core/density/silhouette_factor.h"

namespace curvecast {

/// The product of a density's camera terms, the largest over its cameras. Immutable: any number of threads may ask.
class ViewFactor {
 public:
  /// Prepares the camera terms of a density for curves with the box and origin of this one. Precondition: check_density() finds
  /// nothing.
  ViewFactor(const SurfaceCurve& curve, const Density& density);

  /// Says whether there are no camera terms: all factors are 1.
  bool is_one() const { return cameras_.empty(); }
  /// Returns the curve's normals beside creases (L), where it looks at them; else nothing. The curve outlives them.
  std::span<const Direction8> beside() const { return beside_; }
  /// Says whether PictureDetail is all that the density has besides: ranked points know it.
  bool is_fixed_by_detail() const { return is_fixed_by_detail_; }

  /// Multiplies factor[i] by the view's factor at vertex i of n.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;

  /// Writes to `factor` the factor at the middle of the blocks [begin, end), and to `change` by how much at most it is more or
  /// less on a vertex of the block, relative to the middle. `change` is infinite where no bound is known, as where the surface's
  /// outline may pass through the block. Where no vertex is seen the factor is 0, and `change` means nothing.
  void of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* __restrict factor,
                 float* __restrict change) const;

  /// Writes to `most` an upper bound of the factor on the vertices of each of n blocks, but for rounding.
  void most_of_blocks(const BlockColumns& blocks, std::size_t n, float* most) const;

  /// Returns the pixels per squared unit of the file where a screen term is 1.
  double pixels() const { return pixels_; }

 private:
  using Factor = std::variant<SilhouetteFactor, DistanceFactor, FrustumFactor, ScreenFactor, PictureFactor>;

  std::vector<std::vector<Factor>> cameras_;
  double pixels_ = 0;
  std::span<const Direction8> beside_;
  bool is_fixed_by_detail_ = false;
};

}  // namespace curvecast
