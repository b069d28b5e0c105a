#include "core/progressive/relax_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "tests/core/progressive/flat_group.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// Anywhere in their children; every fourth is of a level before.
std::vector<RankedPoint> points_in(const GroupCandidates& candidates) {
  return points_at(candidates, [](std::size_t c) { return (c * 37 + 11) % kCandidates; });
}

double least_distance(const std::vector<RankedPoint>& points) {
  double least = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double x = points[i].position[0] - points[j].position[0], y = points[i].position[1] - points[j].position[1];
      least = std::min(least, std::hypot(x, y));
    }
  }
  return least;
}

TEST(RelaxPoints, PointsKeepFartherApartAndStayInTheirStrata) {
  FlatCandidates group;
  const std::vector<RankedPoint> before = points_in(group.candidates);
  std::vector<RankedPoint> points = before;
  relax_points(group.candidates, {}, points);
  EXPECT_GT(least_distance(points), 2 * least_distance(before));
  expect_in_their_strata(points, before);
}

/// Root mean square over many discs within the square: by how much their share of the points differs from their area.
double discrepancy(const std::vector<RankedPoint>& points) {
  double sum = 0;
  constexpr int kDiscs = 2000;
  for (std::uint64_t i = 0; i < kDiscs; ++i) {
    const double radius = 0.1 + 0.3 * random_unit(1, i);
    const double x = radius + (1 - 2 * radius) * random_unit(2, i), y = radius + (1 - 2 * radius) * random_unit(3, i);
    const auto inside = std::count_if(points.begin(), points.end(), [&](const RankedPoint& p) {
      return std::hypot(static_cast<double>(p.position[0]) - x, static_cast<double>(p.position[1]) - y) < radius;
    });
    sum += std::pow(static_cast<double>(inside) / static_cast<double>(points.size()) - std::numbers::pi * radius * radius, 2);
  }
  return std::sqrt(sum / kDiscs);
}

TEST(RelaxPoints, PointsAreMoreEven) {
  FlatCandidates group;
  const std::vector<RankedPoint> before = points_in(group.candidates);
  std::vector<RankedPoint> points = before;
  relax_points(group.candidates, {}, points);
  EXPECT_LT(discrepancy(points), 0.82 * discrepancy(before));
}

TEST(RelaxPoints, HeedsPointsOfOtherGroups) {
  FlatCandidates group;
  std::vector<RankedPoint> points = points_in(group.candidates);
  const Vec3f& centre = group.candidates.child(101).centre;
  const RankedPoint other{{{{centre.x(), centre.y(), 0}, {0, 0, 1}, 0, 0, 0}, 0}, 0, 5};
  const auto distance = [&] {
    return std::hypot(points[101].position[0] - other.position[0], points[101].position[1] - other.position[1]);
  };
  relax_points(group.candidates, {}, points);
  const float alone = distance();
  relax_points(group.candidates, {&other, 1}, points);
  EXPECT_GT(distance(), alone);
}

TEST(RelaxPoints, PointsInACrowdStay) {
  FlatCandidates group;
  const std::vector<RankedPoint> before = points_in(group.candidates);
  const std::vector<RankedPoint> crowd(10'000, before[100]);  // of a level before: it stays itself
  const auto is_moved_beside = [&](std::span<const RankedPoint> near) {
    std::vector<RankedPoint> points = before;
    relax_points(group.candidates, near, points);
    return std::memcmp(points.data(), before.data(), points.size() * sizeof(RankedPoint)) != 0;
  };
  EXPECT_TRUE(is_moved_beside(std::span(crowd).first(10)));
  EXPECT_FALSE(is_moved_beside(crowd));
}

}  // namespace
}  // namespace curvecast
