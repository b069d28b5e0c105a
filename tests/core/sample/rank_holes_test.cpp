#include "core/sample/rank_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr RankBlock kBlock{3, 0};

/// In the middle of their children; every fourth is of a level before.
std::vector<RankedPoint> points_in(const RankPlaces& places) {
  std::vector<RankedPoint> points;
  for (std::uint32_t c = 0; c < places.size(); ++c) {
    const Places& own = places.places(c);
    const auto middle = static_cast<std::size_t>(std::min_element(own.away, own.away + kPlaces) - own.away);
    points.push_back(places.point(c, middle, c % 4 == 0 ? c / 4 : 64 + c - c / 4 - 1));
  }
  return points;
}

/// Sends the points of the children about a place as far away from it as they can go.
void make_hole(const RankPlaces& places, const Vec3f& at, std::vector<RankedPoint>& points) {
  for (std::uint32_t c = 0; c < points.size(); ++c) {
    const auto distance = [&](const RankedPoint& p) { return (Vec3f(p.position[0], p.position[1], p.position[2]) - at).norm(); };
    if (points[c].rank < 64 || distance(points[c]) > 0.1f) continue;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const RankedPoint there = places.point(c, k, points[c].rank);
      if (distance(there) > distance(points[c])) points[c] = there;
    }
  }
}

/// The distance of the loneliest place within a quarter of the square about its middle, in lattice distances of all points.
double widest_hole(const std::vector<RankedPoint>& points) {
  double widest = 0;
  for (double x = 0.25; x < 0.75; x += 0.01) {
    for (double y = 0.25; y < 0.75; y += 0.01) {
      double nearest = 1;
      for (const RankedPoint& p : points) nearest = std::min(nearest, std::hypot(p.position[0] - x, p.position[1] - y));
      widest = std::max(widest, nearest);
    }
  }
  return widest / std::sqrt(2 / (std::numbers::sqrt3 * static_cast<double>(points.size())));
}

/// The worst that can be made of points_in() about a corner of strata.
std::vector<RankedPoint> points_about_a_hole(const RankPlaces& places) {
  std::vector<RankedPoint> worst = points_in(places);
  for (const int x : {6, 7, 8, 9, 10}) {
    for (const int y : {6, 7, 8, 9, 10}) {
      std::vector<RankedPoint> points = points_in(places);
      make_hole(places, {static_cast<float>(x) / 16, static_cast<float>(y) / 16, 0}, points);
      if (widest_hole(points) > widest_hole(worst)) worst = points;
    }
  }
  return worst;
}

TEST(RankHoles, AreClosedByPointsThatStayInTheirStrata) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const RankPlaces places(strata, kBlock, 0);
  const std::vector<RankedPoint> before = points_about_a_hole(places);
  std::vector<RankedPoint> points = before;
  close_holes(strata, places, {}, {}, points);
  EXPECT_GT(widest_hole(before), kWideHole);
  EXPECT_LT(widest_hole(points), widest_hole(before) - 0.05);
  for (std::size_t c = 0; c < points.size(); ++c) {
    EXPECT_EQ(points[c].coordinate >> child_shift(kBlock.level), c);
    EXPECT_EQ(points[c].rank, before[c].rank);
    EXPECT_TRUE(c % 4 != 0 || std::memcmp(&points[c], &before[c], sizeof(RankedPoint)) == 0);
  }
}

TEST(RankHoles, PointsThatMoveKeepHalfTheLatticeDistance) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const RankPlaces places(strata, kBlock, 0);
  const std::vector<RankedPoint> before = points_about_a_hole(places);
  std::vector<RankedPoint> points = before;
  close_holes(strata, places, {}, {}, points);
  for (std::size_t c = 0; c < points.size(); ++c) {
    if (points[c].coordinate == before[c].coordinate) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i == c) continue;
      const double x = points[i].position[0] - points[c].position[0], y = points[i].position[1] - points[c].position[1];
      EXPECT_GE(std::hypot(x, y) * std::sqrt(std::numbers::sqrt3 / 2 * (std::max(points[i].rank, points[c].rank) + 1)), 0.499);
    }
  }
}

TEST(RankHoles, PointsStayWhereThereAreNone) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const RankPlaces places(strata, kBlock, 0);
  // All of them from the beginning, as far as anyone can tell: nothing comes late, nothing may move.
  std::vector<RankedPoint> points = points_in(places);
  for (RankedPoint& p : points) p.rank = p.rank % 64;
  const std::vector<RankedPoint> before = points;
  close_holes(strata, places, {}, {}, points);
  EXPECT_EQ(std::memcmp(points.data(), before.data(), points.size() * sizeof(RankedPoint)), 0);
}

}  // namespace
}  // namespace curvecast
