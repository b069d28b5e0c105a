// The factor of a picture term without its detail: a screen term, a view term and a wider frustum term in one pass, in which what
// faces away counts beside creases whose other side is seen.
#pragma once

#include <array>

#include "core/density/camera_frame.h"
#include "core/density/frustum_factor.h"
#include "core/density/screen_factor.h"
#include "core/density/silhouette_factor.h"

namespace curvecast {

class PictureFactor {
 public:
  /// `wider`: of a camera whose picture shows kPictureMargin more. `weight`: as of ScreenFactor.
  PictureFactor(const CameraFrame& frame, const CameraFrame& wider, float weight);

  // See ViewFactor. Blocks, whose normals' spread has those beside creases in it, need no other treatment there.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor, float* __restrict change) const;
  /// Multiplies by an upper bound on each block's vertices, closer than those of the three factors are together.
  void multiply_most(const BlockColumns& blocks, std::size_t n, float* __restrict most) const;

 private:
  template <bool kBeside>
  void multiply_each(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_beside(const VertexColumns& vertices, std::size_t n, float* factor) const;

  ScreenFactor screen_;
  SilhouetteFactor silhouette_;
  FrustumFactor frustum_;
  // See CameraFrame.
  float x_, y_, z_, slope_, blur_;
  AffineForm depth_;
  float depth_reach_, weight_;
  std::array<AffineForm, 5> sides_;
  float scale_, side_blur_;
};

}  // namespace curvecast
