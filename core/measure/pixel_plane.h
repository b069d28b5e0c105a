// A number for each pixel, and what filters do with it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace curvecast {

struct PixelPlane {
  int width = 0, height = 0;
  std::vector<float> values;  // rows from top to bottom

  PixelPlane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Returns 2 radius + 1 values of a Gaussian bell, which add up to 1.
std::vector<float> gaussian_kernel(int radius, double deviation);

/// Convolves each row with `across` and each column with `down`, which have an odd number of values each: value i of 2 r + 1
/// weighs the pixel r - i to the right or below. Beyond the picture its outermost pixels go on. On all threads.
PixelPlane convolve(const PixelPlane& plane, std::span<const float> across, std::span<const float> down);

}  // namespace curvecast
