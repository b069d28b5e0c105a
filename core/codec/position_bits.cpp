#include "core/codec/position_bits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/density/density.h"

namespace curvecast {
double pixels_per_length(const Camera& camera, double distance, double diagonal) {
  const double pixels = pixels_at_unit_depth(camera);
  if (camera.is_orthographic()) return pixels;
  const double up = std::tan(0.5 * camera.fov), right = up * camera.aspect;
  // In a corner of the picture what is as far from the eye is drawn larger than in the middle, by one over its cosine squared.
  const double corner = 1 + up * up + right * right;
  return pixels * corner / std::max(distance, kNearPlane * diagonal);
}

int position_bits_for(double pixels, double box_size) {
  // A point moves by half a step of each coordinate at most.
  const double most_step = 2 * kMostPixelsMoved / (std::numbers::sqrt3 * pixels);
  int bits = kLeastPositionBits;
  while (bits < kMostPositionBits && box_size / (std::exp2(bits) - 1) > most_step) ++bits;
  return bits;
}

}  // namespace curvecast
