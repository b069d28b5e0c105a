#include "core/measure/pixel_plane.h"

#include <gtest/gtest.h>

#include <numeric>

namespace curvecast {
namespace {

PixelPlane with_a_dot(int width, int height, int x, int y) {
  PixelPlane plane(width, height);
  plane.row(y)[x] = 1;
  return plane;
}

TEST(PixelPlane, ADotBecomesTheKernel) {
  const std::vector<float> across = {1, 2, 4}, down = {3, 5, 7, 11, 13};
  const PixelPlane out = convolve(with_a_dot(9, 11, 4, 5), across, down);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool is_near = std::abs(x - 4) <= 1 && std::abs(y - 5) <= 2;
      EXPECT_EQ(out.row(y)[x], is_near ? across[static_cast<std::size_t>(x - 3)] * down[static_cast<std::size_t>(y - 3)] : 0)
          << x << ' ' << y;
    }
  }
}

TEST(PixelPlane, EvenPicturesStayEvenUpToTheirBorder) {
  PixelPlane plane(3, 2);
  plane.values.assign(6, 5.0f);
  const std::vector<float> kernel = gaussian_kernel(6, 2.5);  // wider than the picture
  EXPECT_NEAR(std::accumulate(kernel.begin(), kernel.end(), 0.0), 1, 1e-6);
  for (const float value : convolve(plane, kernel, kernel).values) EXPECT_NEAR(value, 5, 1e-5);
}

TEST(PixelPlane, ShortFiltersLeaveTheOtherDirectionAlone) {
  const std::vector<float> identity = {1}, shift = {1, 0, 0};
  const PixelPlane out = convolve(with_a_dot(5, 5, 2, 2), identity, shift);
  EXPECT_EQ(out.row(1)[2], 1);
  EXPECT_EQ(std::accumulate(out.values.begin(), out.values.end(), 0.0f), 1);
}

}  // namespace
}  // namespace curvecast
