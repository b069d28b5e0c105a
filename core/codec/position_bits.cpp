#include "core/codec/position_bits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/density/density.h"

namespace curvecast {
namespace {

// Two steps of the ladder: the camera has gone 64 times as far away. Each point then takes a byte more than it needs.
constexpr int kMostExtraBits = 6;

}  // namespace

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
  const auto found = std::ranges::find_if(kPositionBits, [&](int bits) { return box_size / (std::exp2(bits) - 1) <= most_step; });
  return found != kPositionBits.end() ? *found : kPositionBits.back();
}

bool may_keep_position_bits(int held, int wanted) { return held >= wanted && held - wanted < kMostExtraBits; }

}  // namespace curvecast
