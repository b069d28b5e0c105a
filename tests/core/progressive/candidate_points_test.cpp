#include "core/progressive/candidate_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/random.h"
#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr StratumGroup kGroup{3, 0};

TEST(CandidatePoints, LieInTheirStrata) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const GroupCandidates candidates(strata, kGroup, 1);
  ASSERT_EQ(candidates.size(), 256u);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    for (std::size_t k = 0; k < kCandidates; ++k) {
      const RankedPoint p = candidates.point(c, k, 77);
      EXPECT_EQ(p.curve_position >> child_shift(kGroup.level), c);
      EXPECT_EQ(p.rank, 77u);
      EXPECT_EQ(p.position[0], candidates.in_child(c).x[k]);
      const Vec3f away = Vec3f(p.position[0], p.position[1], p.position[2]) - candidates.child(c).centre;
      EXPECT_LE(away.norm(), candidates.child(c).radius * 1.0001f);
    }
  }
}

TEST(CandidatePoints, KnowTheNearestPointThatTheyFace) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const GroupCandidates candidates(strata, kGroup, 0);
  std::array<float, kCandidates> least;
  least.fill(kFar);
  RankedPoint p{{{{0.5f, 0.5f, 0.25f}, {0, 0, 1}, 0, 0, 0}, 0}, 0, 0};
  candidates.take_nearer(100, p, 2, least.data());
  const CandidatePoints& in_child = candidates.in_child(100);
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const double x = in_child.x[k] - 0.5, y = in_child.y[k] - 0.5;
    EXPECT_NEAR(least[k], 2 * (x * x + y * y + 0.0625), 1e-5);
  }
  const std::array<float, kCandidates> before = least;
  p.position[2] = 0;
  p.normal[2] = -1;
  candidates.take_nearer(100, p, 2, least.data());
  EXPECT_EQ(least, before);
}

TEST(CandidatePoints, TheBestIsFarthestAndTheCentralOneIsFarEnough) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    CandidatePoints candidates{};
    // Few values, so that some are equal.
    const auto value = [&](std::uint64_t i) { return static_cast<float>(static_cast<int>(10 * random_unit(seed, i))); };
    for (std::size_t k = 0; k < kCandidates; ++k) {
      candidates.nearest_lower[k] = value(3 * k);
      candidates.nearest_higher[k] = value(3 * k + 1);
      candidates.from_centre[k] = value(3 * k + 2);
    }
    const float n = 1.5f;
    const auto apart = [&](std::size_t k) { return std::min(candidates.nearest_lower[k] * n, candidates.nearest_higher[k]); };
    const BestCandidate best = best_candidate(candidates.nearest_lower, candidates.nearest_higher, n);
    EXPECT_EQ(apart(best.index), best.value);
    for (std::size_t k = 0; k < kCandidates; ++k) EXPECT_LE(apart(k), best.value);
    for (const float enough : {0.0f, 0.5f * best.value, best.value}) {
      const std::size_t central = central_candidate(candidates, candidates.nearest_higher, n, enough);
      EXPECT_GE(apart(central), enough);
      for (std::size_t k = 0; k < kCandidates; ++k) {
        EXPECT_TRUE(apart(k) < enough || candidates.from_centre[k] >= candidates.from_centre[central]);
      }
    }
    const float* const lower = candidates.nearest_lower;
    EXPECT_EQ(largest_of(lower), *std::max_element(lower, lower + kCandidates));
  }
}

// As of a file that somebody has cut while it is read.
TEST(CandidatePoints, AreFoundAmongThemselvesWhateverTheirNumbersAre) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  CandidatePoints candidates;
  for (const float from_centre : {kNone, kFar, 2 * kFar}) {
    std::fill_n(candidates.from_centre, kCandidates, from_centre);
    for (const float nearest : {kNone, -2.F, 1.F}) {
      std::fill_n(candidates.nearest_lower, kCandidates, nearest);
      std::fill_n(candidates.nearest_higher, kCandidates, nearest);
      for (const float enough : {kNone, -1.F, 0.5F, kFar}) {
        EXPECT_LT(central_candidate(candidates, candidates.nearest_higher, 1, enough), kCandidates);
      }
      EXPECT_LT(best_candidate(candidates.nearest_lower, candidates.nearest_higher, 1).index, kCandidates);
    }
  }
}

}  // namespace
}  // namespace curvecast
