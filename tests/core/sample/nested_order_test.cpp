#include "core/sample/nested_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/with_threads.h"
#include "core/measure/measure_points.h"
#include "core/pipeline/scatter_mesh.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

std::vector<std::uint32_t> order_of(const PointSet& points, std::uint64_t seed = 0, int threads = 0) {
  const auto made = with_threads({.threads = threads}, [&] { return nested_order(points.positions, points.radii, seed); });
  EXPECT_TRUE(made.ok()) << made.status();
  return made.value_or(std::vector<std::uint32_t>());
}

PointSet scattered(const PolygonSoup& soup, std::uint64_t points, const Density& density = {}) {
  const absl::StatusOr<LoadedMesh> mesh = load_mesh(soup, "shape");
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  absl::StatusOr<ScatteredPoints> made = scatter_mesh(*mesh, {.density = density, .points = points, .rounds = 2});
  EXPECT_TRUE(made.ok()) << made.status();
  return std::move(made->points);
}

/// The points of the lowest ranks.
std::vector<Vec3d> prefix(const PointSet& points, const std::vector<std::uint32_t>& ranks, std::size_t count) {
  std::vector<Vec3d> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (ranks[i] < count) out.push_back(points.origin + points.positions[i].cast<double>());
  }
  return out;
}

TEST(NestedOrder, EachPointHasARankOfItsOwn) {
  for (const std::uint64_t n : {1u, 2u, 3u, 5u, 16u, 17u, 250u, 1024u, 1025u, 4097u}) {
    const PointSet points = scattered(curvecast::testing::icosphere(2), n);
    for (const std::uint64_t seed : {0u, 77u}) {
      std::vector<std::uint32_t> ranks = order_of(points, seed);
      ASSERT_EQ(ranks.size(), n);
      std::sort(ranks.begin(), ranks.end());
      for (std::uint32_t i = 0; i < n; ++i) ASSERT_EQ(ranks[i], i) << n;
    }
  }
  const auto none = nested_order({}, {}, 0);
  ASSERT_TRUE(none.ok());
  EXPECT_TRUE(none->empty());
}

TEST(NestedOrder, PowersOfFourHaveAPointInEachPartOfTheCurve) {
  for (const std::uint64_t n : {1024u, 3000u}) {
    const PointSet points = scattered(curvecast::testing::torus(60, 40), n);
    const std::vector<std::uint32_t> ranks = order_of(points);
    for (std::uint64_t parts = 1; 2 * parts <= n; parts *= 4) {
      std::vector<int> count(parts);
      for (std::uint64_t part = 0; part < parts; ++part) {
        for (std::uint64_t i = part * n / parts; i < (part + 1) * n / parts; ++i) count[part] += ranks[i] < parts ? 1 : 0;
      }
      EXPECT_THAT(count, ::testing::Each(1)) << parts << " of " << n;
    }
  }
}

TEST(NestedOrder, EveryPrefixIsEven) {
  const PolygonSoup soup = curvecast::testing::torus(80, 60);
  const PointSet points = scattered(soup, 5000);
  const std::vector<std::uint32_t> ranks = order_of(points, 3);
  std::vector<std::vector<Vec3d>> sets;
  for (const std::size_t count : {256u, 700u, 1250u, 2500u, 3750u}) sets.push_back(prefix(points, ranks, count));
  const absl::StatusOr<MeasureReport> report = measure_points(curvecast::testing::make_mesh(soup), sets, {});
  ASSERT_TRUE(report.ok()) << report.status();
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const auto& set = report->sets[k];
    EXPECT_LT(set.ball.rms_relative, 0.45) << k;  // of random points'
    EXPECT_LT(set.ring.rms_relative, 0.45) << k;
    EXPECT_GT(set.spacing.min, 0.25) << k;
    EXPECT_LT(set.coverage, 2.8) << k;  // of random points: 3.8
  }
}

TEST(NestedOrder, PrefixesHaveTheDensityOfTheWhole) {
  const PolygonSoup soup = curvecast::testing::icosphere(4);
  const PointSet points = scattered(soup, 8000, {ExpressionTerm{"1 + 9 * (z > 0)"}});
  const std::vector<std::uint32_t> ranks = order_of(points);
  for (const std::size_t count : {100u, 500u, 1000u, 3000u, 5000u, 8000u}) {
    const std::vector<Vec3d> some = prefix(points, ranks, count);
    const auto above = std::count_if(some.begin(), some.end(), [](const Vec3d& p) { return p.z() > 0; });
    EXPECT_NEAR(static_cast<double>(above) / static_cast<double>(count), 10.0 / 11, 0.025) << count;
  }
}

TEST(NestedOrder, IsTheSameForAnyNumberOfThreads) {
  const PointSet points = scattered(curvecast::testing::icosphere(4), 20'000);
  const std::vector<std::uint32_t> ranks = order_of(points, 5, 1);
  EXPECT_EQ(order_of(points, 5, 2), ranks);
  EXPECT_EQ(order_of(points, 5, 7), ranks);
  EXPECT_NE(order_of(points, 6), ranks);
}

TEST(NestedOrder, PointsAtOnePlaceAreOrderedToo) {
  PointSet points;
  points.positions.assign(1000, Vec3f(1, 2, 3));
  points.radii.assign(1000, 0.5f);
  std::vector<std::uint32_t> ranks = order_of(points);
  std::sort(ranks.begin(), ranks.end());
  for (std::uint32_t i = 0; i < 1000; ++i) ASSERT_EQ(ranks[i], i);
}

TEST(NestedOrder, EndsWhenItIsCancelled) {
  const PointSet points = scattered(curvecast::testing::icosphere(2), 5000);
  std::atomic<bool> cancel = true;
  EXPECT_TRUE(absl::IsCancelled(nested_order(points.positions, points.radii, 0, {.cancel = &cancel}).status()));
}

}  // namespace
}  // namespace curvecast
