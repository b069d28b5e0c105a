#include "core/progressive/shrink_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "tests/core/progressive/flat_group.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// In the middle of their children; every fourth is of a level before.
std::vector<RankedPoint> points_in(const GroupCandidates& candidates) {
  return points_at(candidates, [&](std::size_t c) {
    const CandidatePoints& own = candidates.in_child(c);
    return static_cast<std::size_t>(std::min_element(own.from_centre, own.from_centre + kCandidates) - own.from_centre);
  });
}

/// Sends the points of the children about a place as far away from it as they can go.
void make_gap(const GroupCandidates& candidates, const Vec3f& at, std::vector<RankedPoint>& points) {
  for (std::uint32_t c = 0; c < points.size(); ++c) {
    const auto distance = [&](const RankedPoint& p) { return (Vec3f(p.position[0], p.position[1], p.position[2]) - at).norm(); };
    if (points[c].rank < 64 || distance(points[c]) > 0.1f) continue;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      const RankedPoint there = candidates.point(c, k, points[c].rank);
      if (distance(there) > distance(points[c])) points[c] = there;
    }
  }
}

/// The distance of the loneliest place within a quarter of the square about its middle, in lattice distances of all points.
double widest_gap(const std::vector<RankedPoint>& points) {
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
std::vector<RankedPoint> points_about_a_gap(const GroupCandidates& candidates) {
  std::vector<RankedPoint> worst = points_in(candidates);
  for (const int x : {6, 7, 8, 9, 10}) {
    for (const int y : {6, 7, 8, 9, 10}) {
      std::vector<RankedPoint> points = points_in(candidates);
      make_gap(candidates, {static_cast<float>(x) / 16, static_cast<float>(y) / 16, 0}, points);
      if (widest_gap(points) > widest_gap(worst)) worst = points;
    }
  }
  return worst;
}

/// points_about_a_gap(), and what closing it makes of them.
std::pair<std::vector<RankedPoint>, std::vector<RankedPoint>> shrunk_gap() {
  const FlatCandidates group;
  const std::vector<RankedPoint> before = points_about_a_gap(group.candidates);
  std::vector<RankedPoint> points = before;
  shrink_gaps(group.strata, group.candidates, {}, {}, points);
  return {before, points};
}

TEST(ShrinkGaps, MovesPointsThatStayInTheirStrata) {
  const auto [before, points] = shrunk_gap();
  EXPECT_GT(widest_gap(before), kWideGap);
  EXPECT_LT(widest_gap(points), widest_gap(before) - 0.05);
  expect_in_their_strata(points, before);
}

/// Points that have moved are no nearer to any other than half the lattice distance of the points there are when the later comes.
void expect_moved_points_apart(const std::vector<RankedPoint>& points, const std::vector<RankedPoint>& before) {
  for (std::size_t c = 0; c < points.size(); ++c) {
    if (points[c].curve_position == before[c].curve_position) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i == c) continue;
      const double x = points[i].position[0] - points[c].position[0], y = points[i].position[1] - points[c].position[1];
      EXPECT_GE(std::hypot(x, y) * std::sqrt(std::numbers::sqrt3 / 2 * (std::max(points[i].rank, points[c].rank) + 1)), 0.499);
    }
  }
}

TEST(ShrinkGaps, PointsThatMoveKeepHalfTheLatticeDistance) {
  const auto [before, points] = shrunk_gap();
  expect_moved_points_apart(points, before);
}

TEST(ShrinkGaps, KeepsItsPromisesWhereverThePointsAre) {
  const FlatCandidates group;
  std::size_t moved = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const std::vector<RankedPoint> before = points_at(group.candidates, [&](std::size_t c) {
      return static_cast<std::size_t>(random_unit(seed, c) * static_cast<double>(kCandidates));
    });
    std::vector<RankedPoint> points = before;
    shrink_gaps(group.strata, group.candidates, {}, {}, points);
    expect_in_their_strata(points, before);
    expect_moved_points_apart(points, before);
    for (std::size_t c = 0; c < points.size(); ++c) moved += points[c].curve_position != before[c].curve_position ? 1 : 0;
  }
  EXPECT_GT(moved, 0u);
}

TEST(ShrinkGaps, LeavesTheGapsOfACrowd) {
  const FlatCandidates group;
  const std::vector<RankedPoint> before = points_about_a_gap(group.candidates);
  // Copies of points that are there leave every gap as wide as it is.
  std::vector<RankedPoint> copies;
  for (int i = 0; i < 200; ++i) {
    for (std::size_t c = 0; c < before.size(); c += 4) copies.push_back(before[c]);
  }
  std::vector<RankedPoint> points = before;
  shrink_gaps(group.strata, group.candidates, copies, {}, points);
  EXPECT_EQ(std::memcmp(points.data(), before.data(), points.size() * sizeof(RankedPoint)), 0);
}

TEST(ShrinkGaps, PointsStayWhereThereAreNone) {
  const FlatCandidates group;
  // All of them from the beginning, as far as anyone can tell: nothing comes late, nothing may move.
  std::vector<RankedPoint> points = points_in(group.candidates);
  for (RankedPoint& p : points) p.rank = p.rank % 64;
  const std::vector<RankedPoint> before = points;
  shrink_gaps(group.strata, group.candidates, {}, {}, points);
  EXPECT_EQ(std::memcmp(points.data(), before.data(), points.size() * sizeof(RankedPoint)), 0);
}

}  // namespace
}  // namespace curvecast
