#include "core/measure/star_discrepancy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/base/reversed_bits.h"

namespace curvecast {
namespace {

/// Over all boxes that end at coordinates of points or at 1, with and without their upper sides.
double brute_force(const std::vector<Vec2d>& points) {
  std::vector<double> xs = {1}, ys = {1};
  for (const Vec2d& p : points) xs.push_back(p.x()), ys.push_back(p.y());
  double most = 0;
  for (const double x : xs) {
    for (const double y : ys) {
      double open = 0, closed = 0;
      for (const Vec2d& p : points) {
        open += p.x() < x && p.y() < y;
        closed += p.x() <= x && p.y() <= y;
      }
      const auto n = static_cast<double>(points.size());
      most = std::max({most, x * y - open / n, closed / n - x * y});
    }
  }
  return most;
}

std::vector<Vec2d> hammersley(int bits) {
  std::vector<Vec2d> points;
  const double n = std::ldexp(1.0, bits);
  for (std::uint64_t i = 0; i < std::uint64_t{1} << bits; ++i) {
    points.emplace_back(static_cast<double>(i) / n, static_cast<double>(reversed_bits(i, bits)) / n);
  }
  return points;
}

TEST(StarDiscrepancy, OfOnePoint) {
  // The box that just takes it in, and the ones beside it.
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Vec2d>{{0.5, 0.5}}), 0.75);
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Vec2d>{{0, 0}}), 1);
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Vec2d>{{1, 1}}), 1);
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Vec2d>{{0.9, 0.4}}), 0.9);
}

TEST(StarDiscrepancy, OfRegularGrids) {
  for (const int n : {2, 3, 10, 55}) {
    std::vector<Vec2d> points;
    for (int i = 0; i < n * n; ++i) points.emplace_back((i % n + 0.5) / n, (i / n + 0.5) / n);
    EXPECT_NEAR(star_discrepancy(points), 1 - std::pow(1 - 0.5 / n, 2), 1e-12) << n;
  }
}

TEST(StarDiscrepancy, OfHammersleysPointsIsWhatTheoryHas) {
  // Halton and Zaremba, "The extreme and L2 discrepancies of some plane sets" (1969): at most (m / 3 + 3) / N for N = 2^m, and it
  // does grow like that.
  double before = 0;
  for (int bits = 2; bits <= 12; ++bits) {
    const double scaled = std::ldexp(star_discrepancy(hammersley(bits)), bits);
    EXPECT_LE(scaled, bits / 3.0 + 3);
    EXPECT_GE(scaled, bits / 3.0 + 1);
    if (bits > 4) {
      EXPECT_NEAR(scaled - before, 1 / 3.0, 0.06) << bits;
    }
    before = scaled;
  }
}

TEST(StarDiscrepancy, IsThatOfBruteForceInAnyOrder) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::vector<Vec2d> points;
    for (std::uint64_t i = 0; i < 40; ++i) {
      Vec2d p(random_unit(seed, 2 * i), random_unit(seed, 2 * i + 1));
      if (seed % 2 == 1) p = (4 * p).array().round() / 4;  // many on one line, at one place, and on the sides
      points.push_back(p);
    }
    const double found = star_discrepancy(points);
    EXPECT_NEAR(found, brute_force(points), 1e-14) << seed;
    std::reverse(points.begin(), points.end());
    EXPECT_EQ(found, star_discrepancy(points)) << seed;
  }
}

}  // namespace
}  // namespace curvecast
