#include "core/sample/rank_relaxation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr RankBlock kBlock{3, 0};

/// Anywhere in their children; every fourth is of a level before.
std::vector<RankedPoint> points_in(const RankPlaces& places) {
  std::vector<RankedPoint> points;
  for (std::uint32_t c = 0; c < places.size(); ++c) {
    points.push_back(places.point(c, (c * 37 + 11) % kPlaces, c % 4 == 0 ? c / 4 : 64 + c - c / 4 - 1));
  }
  return points;
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

TEST(RankRelaxation, PointsKeepFartherApartAndStayInTheirStrata) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  RankPlaces places(strata, kBlock, 0);
  const std::vector<RankedPoint> before = points_in(places);
  std::vector<RankedPoint> points = before;
  relax_ranks(places, {}, points);
  EXPECT_GT(least_distance(points), 2 * least_distance(before));
  for (std::size_t c = 0; c < points.size(); ++c) {
    EXPECT_EQ(points[c].coordinate >> child_shift(kBlock.level), c);
    EXPECT_EQ(points[c].rank, before[c].rank);
    EXPECT_TRUE(c % 4 != 0 || std::memcmp(&points[c], &before[c], sizeof(RankedPoint)) == 0);
  }
}

TEST(RankRelaxation, HeedsPointsOfOtherBlocks) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  RankPlaces places(strata, kBlock, 0);
  std::vector<RankedPoint> points = points_in(places);
  const RankedPoint other{0, {places.child(101).center.x(), places.child(101).center.y(), 0}, {0, 0, 1}, 0, 5};
  const auto distance = [&] {
    return std::hypot(points[101].position[0] - other.position[0], points[101].position[1] - other.position[1]);
  };
  relax_ranks(places, {}, points);
  const float alone = distance();
  relax_ranks(places, {&other, 1}, points);
  EXPECT_GT(distance(), alone);
}

}  // namespace
}  // namespace curvecast
