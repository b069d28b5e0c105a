#include "core/measure/disc_cover.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Vec2d> random_points(std::size_t n, std::uint64_t seed) {
  std::vector<Vec2d> points;
  for (std::uint64_t i = 0; i < n; ++i) points.emplace_back(random_unit(seed, 2 * i), random_unit(seed, 2 * i + 1));
  return points;
}

TEST(DiscCover, OfDiscsThatAreApart) {
  EXPECT_NEAR(disc_cover(std::vector<Vec2d>{{0.5, 0.5}}, 0.1), kPi * 0.01, 1e-15);
  EXPECT_NEAR(disc_cover(std::vector<Vec2d>{{0, 0}, {0.5, 1}, {0.5, 0.5}}, 0.1), 1.75 * kPi * 0.01, 1e-15);
  EXPECT_NEAR(disc_cover(std::vector<Vec2d>{{0.25, 0.5}, {0.75, 0.5}}, 0.25), 2 * kPi / 16, 1e-15);
}

TEST(DiscCover, CountsWhatSeveralCoverOnce) {
  // Two circles of radius 1/5 whose middles lie as far apart share a lens.
  const double lens = 0.04 * (2 * kPi / 3 - std::numbers::sqrt3 / 2);
  EXPECT_NEAR(disc_cover(std::vector<Vec2d>{{0.4, 0.5}, {0.6, 0.5}}, 0.2), 2 * kPi * 0.04 - lens, 1e-14);
  EXPECT_NEAR(disc_cover(std::vector<Vec2d>(5, Vec2d(0.4, 0.6)), 0.1), kPi * 0.01, 1e-15);
}

TEST(DiscCover, IsNothingWithoutARadiusAndAllWithALargeOne) {
  const std::vector<Vec2d> points = random_points(100, 1);
  EXPECT_EQ(disc_cover(points, 0), 0);
  EXPECT_NEAR(disc_cover(points, 2), 1, 1e-12);
  EXPECT_EQ(disc_cover({}, 0.1), 0);
}

TEST(DiscCover, OfRandomDiscsIsWhatALatticeOfPlacesSees) {
  const std::vector<Vec2d> points = random_points(200, 2);
  constexpr int kSide = 700;
  for (const double radius : {0.01, 0.04, 0.08}) {
    int covered = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec2d place((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
      for (const Vec2d& p : points) {
        if ((p - place).squaredNorm() > radius * radius) continue;
        ++covered;
        break;
      }
    }
    EXPECT_NEAR(disc_cover(points, radius), covered / double{kSide * kSide}, 1e-3) << radius;
  }
}

}  // namespace
}  // namespace curvecast
