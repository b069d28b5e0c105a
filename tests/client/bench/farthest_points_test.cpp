#include "client/bench/peers/farthest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/base/random.h"

namespace curvecast::cli::bench {
namespace {

std::vector<Vec3f> noise(std::size_t n) {
  std::vector<Vec3f> points;
  const auto unit = [](std::uint64_t i) { return static_cast<float>(random_unit(5, i)); };
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2));
  return points;
}

TEST(FarthestPoints, AreThoseOfBruteForce) {
  const std::vector<Vec3f> points = noise(500);
  const std::vector<std::uint32_t> order = farthest_points(points, points.size());
  ASSERT_EQ(order.size(), points.size());
  EXPECT_EQ(order[0], 0u);
  std::vector<float> squares(points.size(), std::numeric_limits<float>::max());
  for (std::size_t i = 1; i < order.size(); ++i) {
    squares[order[i - 1]] = -1;
    for (std::size_t j = 0; j < points.size(); ++j) {
      squares[j] = std::min(squares[j], (points[j] - points[order[i - 1]]).squaredNorm());
    }
    const auto farthest = std::max_element(squares.begin(), squares.end());  // the first of the greatest
    ASSERT_EQ(squares[order[i]], *farthest) << i;
  }
}

TEST(FarthestPoints, TakeEveryPointOnceWhereManyAreAtOnePlace) {
  const std::vector<Vec3f> points(10, Vec3f(1, 2, 3));
  const std::vector<std::uint32_t> order = farthest_points(points, 10);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(order[i], i);
  EXPECT_TRUE(farthest_points(points, 0).empty());
}

}  // namespace
}  // namespace curvecast::cli::bench
