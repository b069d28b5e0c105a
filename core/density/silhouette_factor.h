// The factor of a view term, which enhances silhouettes: more points towards the outline, none on what faces away (paper, section
// 4.3).
#pragma once

#include "core/density/camera_frame.h"
#include "core/density/density.h"

namespace curvecast {

class SilhouetteFactor {
 public:
  SilhouetteFactor(const CameraFrame& frame, const ViewTerm& term);

  // See ViewFactor.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor, float* __restrict change) const;

 private:
  float x_, y_, z_, slope_, s0_, blur_;
};

}  // namespace curvecast
