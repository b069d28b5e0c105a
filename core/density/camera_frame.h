// A camera in the units of a curve: lengths are in diagonals of the curve's box, the origin is the curve's, and an eye that is so
// far that rays are parallel is moved nearer. So squares of lengths fit a float for models of every size.
#pragma once

#include <array>
#include <cstddef>

#include "core/curve/surface_curve.h"
#include "core/density/camera.h"

namespace curvecast {

/// Columns of curve vertices: positions relative to the curve's origin, in the file's units, and normals.
struct VertexColumns {
  const float *x, *y, *z;
  const Snorm16 *nx, *ny, *nz;
  const Direction8* beside = nullptr;  // see SurfaceCurve::beside; null where none is near a crease

  /// Returns a curve's columns from a vertex on.
  static VertexColumns of(const SurfaceCurve& curve, std::size_t begin = 0) {
    return {curve.x.data() + begin,
            curve.y.data() + begin,
            curve.z.data() + begin,
            curve.nx.data() + begin,
            curve.ny.data() + begin,
            curve.nz.data() + begin,
            curve.beside.empty() ? nullptr : curve.beside.data() + begin};
  }
  /// Returns the columns without their first entries.
  VertexColumns from(std::size_t first) const {
    return {x + first, y + first, z + first, nx + first, ny + first, nz + first, beside == nullptr ? nullptr : beside + first};
  }
};

/// Columns of blocks of curve vertices; see CurveBlocks.
struct BlockColumns {
  const float *x, *y, *z, *radius, *nx, *ny, *nz, *spread;

  /// Returns the columns of a curve's blocks.
  static BlockColumns of(const CurveBlocks& blocks) {
    return {blocks.x.data(),  blocks.y.data(),  blocks.z.data(),  blocks.radius.data(),
            blocks.nx.data(), blocks.ny.data(), blocks.nz.data(), blocks.spread.data()};
  }
  /// Returns the columns without their first entries.
  BlockColumns from(std::size_t first) const {
    return {x + first, y + first, z + first, radius + first, nx + first, ny + first, nz + first, spread + first};
  }
};

/// The value (x, y, z) . p + offset, in diagonals, of a position p relative to the curve's origin and in the file's units.
struct AffineForm {
  float x, y, z, offset;

  [[gnu::always_inline]] float at(float px, float py, float pz) const { return x * px + y * py + z * pz + offset; }
};

struct CameraFrame {
  /// Precondition: check_camera() finds nothing.
  CameraFrame(const Camera& camera, const Vec3d& origin, const Box3d& box);

  bool is_orthographic;
  double unit;          // a frame length in the file's units: the diagonal, or more for an eye that was moved nearer
  double box_distance;  // from the eye to the box, in frame lengths; 0 for an eye in the box
  double scale;         // 1 / diagonal
  // The direction from a position p to the eye is (x - slope p.x, y - slope p.y, z - slope p.z). For an orthographic camera the
  // slope is 0 and (x, y, z) a unit vector.
  float x, y, z, slope;
  AffineForm depth;                 // along the view, in frame lengths; 1 everywhere for an orthographic camera
  float depth_reach;                // by how much `depth` differs at most on a length of 1 in the file's units
  std::array<AffineForm, 5> sides;  // distances in diagonals to what bounds the picture, positive inside
  float blur;                       // rounding error of positions, in diagonals
};

/// Rounding error of directions and cosines.
inline constexpr float kCosineBlur = 2e-6f;

/// Normals of a block that differ by more than this from their mean lie on two sides of a crease. The mean then tells little of
/// them: the vertices are looked at one by one.
inline constexpr float kSmoothSpread = 0.5f;

/// Squared distances to the eye count as at least this, so that nothing divides by 0.
inline constexpr float kLeastSquare = 1e-37f;

}  // namespace curvecast
