// How many bits the coordinates of a view's points need, so that rounding them to a lattice moves none of them by more than a
// quarter of a pixel on the picture.
#pragma once

#include <array>

#include "core/density/camera.h"

namespace curvecast {

/// The lattices that are chosen from, as bits of a coordinate over the session's box. A step to the next one is as good as coming
/// eight times as near, so that a moving camera seldom asks for another.
inline constexpr std::array<int, 7> kPositionBits = {11, 14, 17, 20, 23, 26, 29};
inline constexpr int kLeastPositionBits = kPositionBits.front();
/// The most bits with which floats do that count from a corner of the box. On finer lattices positions count from a centre near
/// the eye: around it floats are as fine as the picture needs.
inline constexpr int kMostCornerBits = 20;

/// By how much rounding may move a point on the picture: to the lattice, in all directions together; to a float, each coordinate.
inline constexpr double kMostPixelsMoved = 0.2, kMostFloatPixels = 0.02;

/// Returns the pixels that a length of 1, in the file's units, covers at most on a camera's picture, at `distance` from the eye
/// and farther. Nothing counts as nearer than the near plane: kNearPlane diagonals of the mesh's box. An orthographic camera
/// shows all distances alike. Preconditions: check_camera() finds nothing; distance >= 0.
double pixels_per_length(const Camera& camera, double distance, double diagonal);

/// Returns the least of kPositionBits with which rounding moves no point by more than kMostPixelsMoved where a length of 1 covers
/// `pixels`; the last where none does. `box_size`: of the lattice's side, above 0.
int position_bits_for(double pixels, double box_size);

/// Whether points that a client holds with `held` bits do for a view that asks for `wanted`, so that only what changes is sent:
/// with as many bits or more, unless these are so many more that all points anew, in fewer bytes each, pay in the long run.
bool may_keep_position_bits(int held, int wanted);

}  // namespace curvecast
