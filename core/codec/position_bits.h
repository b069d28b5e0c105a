// How many bits the coordinates of a view's points need, so that rounding them to a lattice moves none of them by more than half
// a pixel on the picture.
#pragma once

#include "core/density/camera.h"

namespace curvecast {

/// The lattices that are chosen from, as bits of a coordinate over the session's box; and the one for points that no camera sees.
inline constexpr int kLeastPositionBits = 8, kMostPositionBits = 29, kPlainPositionBits = 11;
/// How many bits too few the points may have that a client keeps from views from farther away. Of those that it gets with
/// each view few are left when the camera has come as much nearer.
inline constexpr int kMostMissingBits = 2;
/// The most bits with which floats do that count from a corner of the box. On finer lattices positions count from a centre near
/// the eye: around it floats are as fine as the picture needs.
inline constexpr int kMostCornerBits = 20;

/// By how much rounding may move a point on the picture: to the lattice, in all directions together; to a float, each coordinate.
inline constexpr double kMostPixelsMoved = 0.5, kMostFloatPixels = 0.02;

/// Returns the pixels that a length of 1, in the file's units, covers at most on a camera's picture, at `distance` from the eye
/// and farther. Nothing counts as nearer than the near plane: kNearPlane diagonals of the mesh's box. An orthographic camera
/// shows all distances alike. Preconditions: check_camera() finds nothing; distance >= 0.
double pixels_per_length(const Camera& camera, double distance, double diagonal);

/// Returns the least bits, of kLeastPositionBits to kMostPositionBits, with which rounding moves no point by more than
/// kMostPixelsMoved where a length of 1 covers `pixels`; the most where none do. `box_size`: of the lattice's side, above 0.
int position_bits_for(double pixels, double box_size);

}  // namespace curvecast
