// A group of ranked points on a flat square, for tests of what moves them.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "core/progressive/candidate_points.h"
#include "tests/support/flat_curve.h"

namespace curvecast::testing {

inline constexpr StratumGroup kFlatGroup{3, 0};

/// kFlatGroup's candidates on a flat curve, and what they lie on.
struct FlatCandidates {
  decltype(flat_curve(7)) curve = flat_curve(7);
  decltype(flat_surface(curve)) surface = flat_surface(curve);
  CurveStrata strata{*surface};
  GroupCandidates candidates{strata, kFlatGroup, 0};
};

/// One point in each child, at place_of(child); every fourth is of a level before.
template <typename PlaceOf>
std::vector<RankedPoint> points_at(const GroupCandidates& candidates, const PlaceOf& place_of) {
  std::vector<RankedPoint> points;
  for (std::uint32_t c = 0; c < candidates.size(); ++c) {
    points.push_back(candidates.point(c, place_of(c), c % 4 == 0 ? c / 4 : 64 + c - c / 4 - 1));
  }
  return points;
}

/// That points_at() have moved within their strata at most, with their ranks; those of a level before not at all.
inline void expect_in_their_strata(const std::vector<RankedPoint>& points, const std::vector<RankedPoint>& before) {
  for (std::size_t c = 0; c < points.size(); ++c) {
    EXPECT_EQ(points[c].curve_position >> child_shift(kFlatGroup.level), c);
    EXPECT_EQ(points[c].rank, before[c].rank);
    EXPECT_TRUE(c % 4 != 0 || std::memcmp(&points[c], &before[c], sizeof(RankedPoint)) == 0);
  }
}

}  // namespace curvecast::testing
