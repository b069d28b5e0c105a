// Level of detail by distance (paper, section 4.3).
#pragma once

#include "core/density/camera_frame.h"
#include "core/density/density.h"

namespace curvecast {

/// The factor of a local distance term; 1 for an orthographic camera and for a global term.
class DistanceFactor {
 public:
  DistanceFactor(const CameraFrame& frame, const DistanceTerm& term);

  // See ViewFactor.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor, float* __restrict change) const;

 private:
  float x_, y_, z_, slope_, blur_, near_, far_;
};

/// Returns the factor by which global terms lower the number of points: the largest of the cameras', in [0, 1]; 1 without any.
/// Precondition: check_density() finds nothing.
double point_scale(const Density& density, const Box3d& box);

}  // namespace curvecast
