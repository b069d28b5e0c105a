#include "core/progressive/fill_free_group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "core/progressive/candidate_points.h"
#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr int kLevel = 9;
constexpr StratumGroup kGroup{kLevel, 1234};

/// A group of the flat square, filled, and the points that it was filled from.
struct FlatGroup {
  explicit FlatGroup(std::uint64_t seed = 0, bool has_neighbours = true, const std::vector<RankedPoint>& done = {})
      : surface(flat_surface(flat_curve(5))), strata(*surface), points(4 * kGroup.size()) {
    base = first_points(kGroup.index);
    if (has_neighbours) {
      for (const std::uint64_t i : {kGroup.index - 1, kGroup.index + 1}) {
        for (const RankedPoint& p : first_points(i)) open.push_back(p);
      }
    }
    fill_free_group(strata, kGroup, base, done, open, seed, points);
  }

  /// A point in the first child of each of a group's strata.
  std::vector<RankedPoint> first_points(std::uint64_t group) const {
    std::vector<RankedPoint> all;
    for (std::uint64_t s = 0; s < kGroupStrata; ++s) {
      const std::uint64_t stratum = group * kGroupStrata + s;
      const std::uint64_t position = (4 * stratum << child_shift(kLevel)) + (std::uint64_t{1} << (child_shift(kLevel) - 1));
      const double t = unit_curve_position(position);
      CurvePoint at{};
      strata.points_at({&t, 1}, std::ldexp(1.0, -2 * kLevel), {&at, 1});
      all.push_back({at, position, stratum});
    }
    return all;
  }

  std::shared_ptr<const LeafSurface> surface;
  CurveStrata strata;
  std::vector<RankedPoint> base, open, points;
};

double distance(const RankedPoint& a, const RankedPoint& b) {
  return std::hypot(a.position[0] - b.position[0], a.position[1] - b.position[1], a.position[2] - b.position[2]);
}

TEST(FillFreeGroup, HasAPointInEveryStratumAndEveryRankOnce) {
  const FlatGroup group;
  std::set<std::uint64_t> ranks;
  for (std::size_t c = 0; c < group.points.size(); ++c) {
    const RankedPoint& p = group.points[c];
    EXPECT_EQ(p.curve_position >> child_shift(kLevel), kGroup.index * group.points.size() + c);
    if (c % 4 == 0) {
      EXPECT_EQ(p.rank, group.base[c / 4].rank);
      continue;
    }
    EXPECT_GE(p.rank, std::uint64_t{1} << 2 * kLevel);
    EXPECT_LT(p.rank, std::uint64_t{1} << 2 * (kLevel + 1));
    EXPECT_NE(p.face, kNone) << "on the surface itself";
    ranks.insert(p.rank);
  }
  EXPECT_EQ(ranks.size(), 3 * kGroupStrata);
}

TEST(FillFreeGroup, StrataTakeTurns) {
  std::vector<RankedPoint> points = FlatGroup().points;
  std::sort(points.begin(), points.end(), [](const RankedPoint& a, const RankedPoint& b) { return a.rank < b.rank; });
  // After each round of turns all strata have as many points.
  for (std::size_t round = 1; round <= 4; ++round) {
    std::vector<std::size_t> held(kGroupStrata, 0);
    for (std::size_t i = 0; i < round * kGroupStrata; ++i) ++held[points[i].curve_position >> (child_shift(kLevel) + 2) & 63];
    EXPECT_TRUE(std::all_of(held.begin(), held.end(), [&](std::size_t h) { return h == round; })) << round;
  }
}

TEST(FillFreeGroup, PointsKeepApartAtAllTimes) {
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::vector<RankedPoint> points = FlatGroup(seed).points;
    std::sort(points.begin(), points.end(), [](const RankedPoint& a, const RankedPoint& b) { return a.rank < b.rank; });
    for (std::size_t i = kGroupStrata; i < points.size(); ++i) {
      double nearest = 1e9;
      for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, distance(points[i], points[j]));
      const double relative = nearest / static_cast<double>(lattice_distance(1, static_cast<double>(points[i].rank + 1)));
      EXPECT_GT(relative, 0.3) << i;
      sum += relative;
    }
  }
  EXPECT_GT(sum / (4 * 3 * kGroupStrata), 0.65);
}

TEST(FillFreeGroup, KeepsApartFromGroupsThatAreDone) {
  const FlatGroup before;
  std::vector<RankedPoint> done;  // where the group would have its own, were they not there
  for (const RankedPoint& p : before.points) {
    if (p.rank >> 2 * kLevel != 0) done.push_back(p);
  }
  const FlatGroup after(0, true, done);
  double least = 1e9;
  for (const RankedPoint& p : after.points) {
    if (p.rank >> 2 * kLevel == 0) continue;
    for (const RankedPoint& q : done) least = std::min(least, distance(p, q));
  }
  EXPECT_GT(least, 0.2 * static_cast<double>(lattice_distance(1, std::ldexp(1.0, 2 * kLevel + 2))));
}

TEST(FillFreeGroup, HeedsThePointsOfGroupsAround) {
  const FlatGroup alone(0, false), beside;
  const auto nearest = [&](const FlatGroup& group) {
    double least = 1e9;
    for (const RankedPoint& p : group.points) {
      for (const RankedPoint& q : beside.open) least = std::min(least, p.rank >> 2 * kLevel == 0 ? 1e9 : distance(p, q));
    }
    return least;
  };
  EXPECT_GE(nearest(beside), nearest(alone));
  EXPECT_NE(std::memcmp(alone.points.data(), beside.points.data(), alone.points.size() * sizeof(RankedPoint)), 0);
  EXPECT_EQ(std::memcmp(FlatGroup().points.data(), beside.points.data(), beside.points.size() * sizeof(RankedPoint)), 0);
}

}  // namespace
}  // namespace curvecast
