#include "core/progressive/stratum_group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr int kLevel = 3;  // 64 strata become 256: the first group that is full, and a whole level

RankedPoint point_at(const CurveStrata& strata, std::uint64_t curve_position, std::uint32_t rank) {
  const double t = unit_curve_position(curve_position);
  CurvePoint at{};
  strata.points_at({&t, 1}, 1, {&at, 1});
  return {at, curve_position, rank};
}

/// A point in the first child of every stratum.
std::vector<RankedPoint> base_points(const CurveStrata& strata) {
  std::vector<RankedPoint> base;
  for (std::uint32_t s = 0; s < 64; ++s) base.push_back(point_at(strata, (std::uint64_t{s} << 58) + (std::uint64_t{1} << 55), s));
  return base;
}

std::vector<RankedPoint> filled(const CurveStrata& strata, const std::vector<RankedPoint>& done = {}, std::uint64_t seed = 0,
                                const std::vector<RankedPoint>& open = {}) {
  std::vector<RankedPoint> points(256);
  fill_stratum_group(strata, {kLevel, 0}, base_points(strata), done, open, seed, points);
  return points;
}

double distance(const RankedPoint& a, const RankedPoint& b) {
  return std::hypot(a.position[0] - b.position[0], a.position[1] - b.position[1], a.position[2] - b.position[2]);
}

/// Returns the distance from p to the nearest point of a lower rank, in lattice distances of the unit square.
double spacing(const std::vector<RankedPoint>& points, const RankedPoint& p) {
  double least = 1e9;
  for (const RankedPoint& q : points) {
    if (q.rank < p.rank) least = std::min(least, distance(p, q));
  }
  return least / std::sqrt(2 / (std::numbers::sqrt3 * static_cast<double>(p.rank + 1)));
}

TEST(StratumGroup, HasAPointInEveryStratumAndEveryRankOnce) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const std::vector<RankedPoint> points = filled(strata), base = base_points(strata);
  std::set<std::uint64_t> ranks;
  for (std::size_t c = 0; c < points.size(); ++c) {
    EXPECT_EQ(points[c].curve_position >> 56, c);
    EXPECT_EQ(points[c].vertex, strata.vertex_at(unit_curve_position(points[c].curve_position)));
    ranks.insert(points[c].rank);
    if (c % 4 == 0) {
      EXPECT_EQ(points[c].curve_position, base[c / 4].curve_position);
      EXPECT_EQ(points[c].rank, base[c / 4].rank);
    }
  }
  EXPECT_EQ(ranks.size(), 256u);
  EXPECT_EQ(*ranks.rbegin(), 255u);
}

TEST(StratumGroup, StrataTakeTurns) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  std::vector<RankedPoint> points = filled(strata);
  std::sort(points.begin(), points.end(), [](const RankedPoint& a, const RankedPoint& b) { return a.rank < b.rank; });
  // Nobody has a third point before all have two.
  std::vector<int> held(64, 0);
  for (const RankedPoint& p : points) {
    ++held[p.curve_position >> 58];
    if (p.rank < 64) continue;
    const auto [fewest, most] = std::minmax_element(held.begin(), held.end());
    EXPECT_LE(*most - *fewest, 1);
  }
}

TEST(StratumGroup, PointsKeepApart) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::vector<RankedPoint> points = filled(strata, {}, seed);
    for (const RankedPoint& p : points) {
      if (p.rank < 64) continue;
      EXPECT_GT(spacing(points, p), 0.5) << "rank " << p.rank;
    }
  }
}

TEST(StratumGroup, KeepsAwayFromPointsOfOtherGroups) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const std::vector<RankedPoint> alone = filled(strata);
  // One that is there already, and one that comes at the end of this level.
  for (const std::uint64_t rank : {0u, 250u}) {
    RankedPoint other = *std::find_if(alone.begin(), alone.end(), [](const RankedPoint& p) { return p.rank == 200; });
    other.rank = rank;
    for (const RankedPoint& p : filled(strata, {other})) {
      if (p.rank < 64) continue;
      EXPECT_GT(distance(p, other) / std::sqrt(2 / (std::numbers::sqrt3 * static_cast<double>(std::max(p.rank, rank) + 1))), 0.4);
    }
  }
}

TEST(StratumGroup, NeedNotKeepAwayFromTheOtherSideOfASheet) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const std::vector<RankedPoint> alone = filled(strata);
  std::vector<RankedPoint> behind = alone;
  for (RankedPoint& p : behind) p.normal[2] = -1;
  const std::vector<RankedPoint> points = filled(strata, {}, 0, behind);
  for (std::size_t c = 0; c < points.size(); ++c) EXPECT_EQ(points[c].curve_position, alone[c].curve_position);
}

TEST(StratumGroup, EvensOutWhatOtherGroupsHave) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  // The group that is done has all its points of this level early and lies beside the first column of strata.
  std::vector<RankedPoint> done;
  for (std::uint32_t i = 0; i < 32; ++i) {
    const float y = (static_cast<float>(i) + 0.5f) / 32;
    done.push_back({{{{-0.12f, y, 0}, {0, 0, 1}, 0, 0, 0}, 0}, 0, 64 + i});
    done.push_back({{{{-0.12f - 1.0f / 32, y, 0}, {0, 0, 1}, 0, 0, 0}, 0}, 0, 240 + i % 16});
  }
  const auto near_it = [&](const std::vector<RankedPoint>& others, std::uint64_t seed) {
    const std::vector<RankedPoint> points = filled(strata, others, seed);
    return static_cast<double>(std::count_if(points.begin(), points.end(), [](const RankedPoint& p) {
      return p.rank >= 64 && p.rank < 112 && p.position[0] < 0.25f;
    }));
  };
  // Fewer come near it, by more than chance has it: the mean over the seeds is beyond three of its standard errors.
  constexpr std::uint64_t kSeeds = 40;
  double sum = 0, squares = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const double fewer = near_it({}, seed) - near_it(done, seed);
    sum += fewer;
    squares += fewer * fewer;
  }
  const double mean = sum / kSeeds, variance = (squares / kSeeds - mean * mean) / (kSeeds - 1);
  EXPECT_GT(mean, 3 * std::sqrt(variance));
}

TEST(StratumGroup, TakesACurveWithFewerVerticesThanPoints) {
  for (const int level : {0, 2, 4}) {
    const auto curve = flat_curve(level);
    const auto surface = flat_surface(curve);
    const CurveStrata strata(*surface);
    const std::vector<RankedPoint> points = filled(strata);
    for (std::size_t c = 0; c < points.size(); ++c) {
      EXPECT_EQ(points[c].curve_position >> 56, c);
      EXPECT_TRUE(std::isfinite(points[c].position[0]));
    }
  }
}

}  // namespace
}  // namespace curvecast
