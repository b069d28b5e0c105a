// A camera in the units in which a curve's places are looked at: the diagonal of its box is 1, the origin is the curve's, and no
// eye stands farther out than where rays are parallel. So squares fit a float at every size.
#pragma once

#include <array>
#include <cstddef>

#include "core/curve/surface_curve.h"
#include "core/density/camera.h"

namespace curvecast {

/// Curve vertices: where they lie, relative to the curve's origin, and what they face.
struct VertexColumns {
  const float *x, *y, *z;
  const Snorm16 *nx, *ny, *nz;
};

/// Blocks of curve vertices; see CurveBlocks.
struct BlockColumns {
  const float *x, *y, *z, *radius, *nx, *ny, *nz, *spread;
};

/// normal . p + offset, of a place p relative to the curve's origin and in the file's units; in diagonals.
struct AffineForm {
  float x, y, z, offset;
};

struct CameraFrame {
  CameraFrame(const Camera& camera, const Vec3d& origin, const Box3d& box);

  bool is_orthographic;
  double unit;          // one length of the frame in the file's units: the diagonal, or more for an eye that is drawn nearer
  double box_distance;  // from the eye to the box, in frame lengths; 0 within
  double scale;         // the diagonal to 1
  // Towards the eye from a place p: (x - slope p.x, y - slope p.y, z - slope p.z). Without slope, and a unit vector, for an
  // orthographic camera.
  float x, y, z, slope;
  AffineForm depth;                 // along the view, in frame lengths; 1 everywhere for an orthographic camera
  float depth_reach;                // by how much `depth` differs at most on a length of 1 in the file's units
  std::array<AffineForm, 5> sides;  // distances in diagonals to what bounds the picture, positive inside
  float blur;                       // places are known to this, in diagonals
};

/// Directions and cosines are known to this.
inline constexpr float kCosineBlur = 2e-6f;

/// Wherever the eye is, the square of the distance to it is taken as this at least.
inline constexpr float kLeastSquare = 1e-37f;

}  // namespace curvecast
