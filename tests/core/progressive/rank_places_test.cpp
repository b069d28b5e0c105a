#include "core/progressive/rank_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr RankBlock kBlock{3, 0};

TEST(RankPlaces, LieInTheirStrata) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const RankPlaces places(strata, kBlock, 1);
  ASSERT_EQ(places.size(), 256u);
  for (std::size_t c = 0; c < places.size(); ++c) {
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const RankedPoint p = places.point(c, k, 77);
      EXPECT_EQ(p.coordinate >> child_shift(kBlock.level), c);
      EXPECT_EQ(p.rank, 77u);
      EXPECT_EQ(p.position[0], places.places(c).x[k]);
      const Vec3f away = Vec3f(p.position[0], p.position[1], p.position[2]) - places.child(c).center;
      EXPECT_LE(away.norm(), places.child(c).radius * 1.0001f);
    }
  }
}

TEST(RankPlaces, KnowTheNearestPointThatTheyFace) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const RankPlaces places(strata, kBlock, 0);
  std::array<float, kPlaces> least;
  least.fill(kFar);
  RankedPoint p{0, {0.5f, 0.5f, 0.25f}, {0, 0, 1}, 0, 0};
  places.take_nearer(100, p, 2, least.data());
  const Places& in_child = places.places(100);
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const double x = in_child.x[k] - 0.5, y = in_child.y[k] - 0.5;
    EXPECT_NEAR(least[k], 2 * (x * x + y * y + 0.0625), 1e-5);
  }
  const std::array<float, kPlaces> before = least;
  p.position[2] = 0;
  p.normal[2] = -1;
  places.take_nearer(100, p, 2, least.data());
  EXPECT_EQ(least, before);
}

TEST(RankPlaces, BestAndCentralPlace) {
  Places places{};
  std::array<float, kPlaces> after;
  after.fill(10);
  for (std::size_t k = 0; k < kPlaces; ++k) {
    places.before[k] = static_cast<float>(k);
    places.away[k] = static_cast<float>(k % 8);
  }
  after[kPlaces - 1] = 1;
  const BestPlace best = best_place(places.before, after.data(), 0.1f);
  EXPECT_EQ(best.place, kPlaces - 2);
  EXPECT_FLOAT_EQ(best.value, 0.1f * (kPlaces - 2));
  EXPECT_EQ(central_place(places, after.data(), 0.1f, 0.1f * (kPlaces - 12)), kPlaces - 8);
  EXPECT_EQ(largest_of(places.before), static_cast<float>(kPlaces - 1));
}

}  // namespace
}  // namespace curvecast
