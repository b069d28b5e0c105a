#include "core/mesh/triangle_distance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/random.h"

namespace curvecast {
namespace {

TEST(TriangleDistance, OverTheInsideTheSidesAndTheCorners) {
  const Vec3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_DOUBLE_EQ(triangle_distance({1, 1, 0}, a, b, c), 0);
  EXPECT_DOUBLE_EQ(triangle_distance({1, 1, -2}, a, b, c), 2);
  EXPECT_DOUBLE_EQ(triangle_distance({2, -3, 0}, a, b, c), 3);
  EXPECT_DOUBLE_EQ(triangle_distance({-3, -4, 0}, a, b, c), 5);
  EXPECT_NEAR(triangle_distance({4, 4, 0}, a, b, c), std::sqrt(8), 1e-15);
}

TEST(TriangleDistance, OfNeedlesAndPoints) {
  EXPECT_DOUBLE_EQ(triangle_distance({1, 1, 0}, {0, 0, 0}, {3, 0, 0}, {2, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(triangle_distance({0, 0, 7}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}), 7);
}

TEST(TriangleDistance, IsTheLeastOverManyPointsOfTheTriangle) {
  std::uint64_t counter = 0;
  const auto random = [&] { return random_unit(5, counter++); };
  const auto vector = [&] {
    const double x = random(), y = random(), z = random();
    return Vec3d(x, y, z);
  };
  for (int i = 0; i < 50; ++i) {
    const Vec3d p = vector(), a = vector(), b = vector(), c = vector();
    const double distance = triangle_distance(p, a, b, c);
    const Vec3d nearest = nearest_on_triangle(p, a, b, c);
    EXPECT_NEAR((p - nearest).norm(), distance, 1e-12);
    EXPECT_NEAR(triangle_distance(nearest, a, b, c), 0, 1e-12);
    double least = 1e9;
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        const Vec3d q = a + (b - a) * u / kSteps + (c - a) * v / kSteps;
        least = std::min(least, (p - q).norm());
      }
    }
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 2.0 / kSteps);
  }
}

}  // namespace
}  // namespace curvecast
