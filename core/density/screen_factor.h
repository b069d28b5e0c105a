// The factor of a screen term, which spaces points evenly on the screen: how many pixels a piece of the surface covers.
#pragma once

#include <span>
#include <vector>

#include "core/base/simd.h"
#include "core/density/camera_frame.h"
#include "core/density/density.h"

namespace curvecast {

class ScreenFactor {
 public:
  /// `weight`: the camera's, from screen_weights().
  ScreenFactor(const CameraFrame& frame, float weight);

  // See ViewFactor.
  void multiply(const VertexColumns& vertices, std::size_t n, float* factor) const;
  void multiply_blocks(const BlockColumns& blocks, std::size_t n, float* __restrict factor, float* __restrict change) const;

 private:
  float x_, y_, z_, slope_, blur_;
  AffineForm depth_;
  float depth_reach_, depth_blur_, weight_;
};

struct ScreenWeights {
  std::vector<float> of_camera;  // one for each camera; with them the cameras' factors have one unit
  double pixels = 0;             // pixels per squared unit of the file where the factor is 1
};

/// Returns weights with which the factor is about 1 where the surface is nearest to the camera that shows it largest, and never
/// above kMostOnScreen.
ScreenWeights screen_weights(std::span<const Camera> cameras, std::span<const CameraFrame> frames);
inline constexpr float kMostOnScreen = 1e6f;

/// Returns the factor, before it is held below kMostOnScreen, of what is seen with a cosine that is clamped to what counts, at a
/// distance from the eye and a depth along the view.
[[gnu::always_inline]] inline float pixels_on_screen(float weight, float cosine, float distance, float depth) {
  const float z = fast_max(depth, static_cast<float>(kNearPlane));
  return weight * cosine * distance / (z * z * z);
}

}  // namespace curvecast
