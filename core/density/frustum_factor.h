// The factor of a frustum term: 0 outside the camera's picture, 1 inside.
#pragma once

#include <array>

#include "core/density/camera_frame.h"

namespace curvecast {

class FrustumFactor {
 public:
  explicit FrustumFactor(const CameraFrame& frame)
      : sides_(frame.sides), scale_(static_cast<float>(frame.scale)), blur_(frame.blur) {}

  // See ViewFactor.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor, float* __restrict change) const;

 private:
  std::array<AffineForm, 5> sides_;
  float scale_, blur_;
};

}  // namespace curvecast
