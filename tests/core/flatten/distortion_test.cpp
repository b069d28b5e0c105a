#include "core/flatten/distortion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/flatten/flatten.h"

namespace curvecast {
namespace {

DiscMesh two_triangles() {
  DiscMesh disc;
  disc.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  disc.triangles = {{0, 1, 2}, {0, 2, 3}};
  disc.face_of = {0, 1};
  disc.border = {0, 1, 2, 3};
  return disc;
}

TEST(Distortion, CountsFlippedAndEmptyTriangles) {
  const DiscMesh disc = two_triangles();
  EXPECT_EQ(count_flipped(disc, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 0u);
  EXPECT_EQ(count_flipped(disc, {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.5}}), 1u);  // empty
  EXPECT_EQ(count_flipped(disc, {{0, 0}, {1, 0}, {1, 1}, {0.9, 0.1}}), 1u);  // turned
  EXPECT_EQ(count_flipped(disc, {{0, 0}, {0, 1}, {1, 1}, {1, 0}}), 2u);
}

TEST(Distortion, AreaRatioIsSurfaceOverParameterArea) {
  const std::vector<Vec2d> uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0.5}};
  EXPECT_DOUBLE_EQ(area_ratio({two_triangles(), uv}, 0), 4);
  EXPECT_DOUBLE_EQ(area_ratio({two_triangles(), uv}, 1), 8);
}

Distortion summarise(const std::vector<AreaShare>& shares) {
  DistortionSummary summary;
  for (const AreaShare& share : shares) summary.add(share);
  return summary.distortion();
}

TEST(Distortion, QuantilesGoByArea) {
  const Distortion distortion = summarise({{60, 1}, {38.5, 2}, {1, 0.1}, {0.5, 100}});
  EXPECT_DOUBLE_EQ(distortion.p50, 1);
  EXPECT_DOUBLE_EQ(distortion.p99, 10);  // shrinking by 10 counts as 10
  EXPECT_DOUBLE_EQ(distortion.p999, 100);
  EXPECT_DOUBLE_EQ(distortion.max, 100);
  EXPECT_DOUBLE_EQ(distortion.density_p999, 100);
  EXPECT_DOUBLE_EQ(summarise({{99.95, 1}, {0.05, 100}}).density_p999, 1);
  EXPECT_DOUBLE_EQ(summarise({{90, 1}, {10, 0.1}}).density_p999, 1);  // spread out, not squeezed
}

TEST(Distortion, QuantilesOfManyRatiosAreNearThoseOfTheSortedOnes) {
  std::vector<AreaShare> shares;
  for (std::uint64_t i = 0; i < 20'000; ++i) shares.push_back({random_unit(1, i), std::exp(3 * random_unit(2, i) - 1)});
  const Distortion distortion = summarise(shares);
  const auto sorted_quantile = [&](double part) {
    std::sort(shares.begin(), shares.end(), [](const AreaShare& a, const AreaShare& b) { return a.ratio < b.ratio; });
    double total = 0, sum = 0;
    for (const AreaShare& share : shares) total += share.area;
    std::size_t i = 0;
    while ((sum += shares[i].area) <= part * total) ++i;
    return shares[i].ratio;
  };
  EXPECT_NEAR(distortion.density_p999 / sorted_quantile(0.999), 1, 1e-3);
  for (AreaShare& share : shares) share.ratio = std::max(share.ratio, 1 / share.ratio);
  EXPECT_NEAR(distortion.p50 / sorted_quantile(0.5), 1, 1e-3);
  EXPECT_NEAR(distortion.p99 / sorted_quantile(0.99), 1, 1e-3);
  EXPECT_NEAR(distortion.p999 / sorted_quantile(0.999), 1, 1e-3);
  EXPECT_EQ(distortion.max, shares.back().ratio);
}

TEST(Distortion, SummariesAddUp) {
  DistortionSummary one, other, both;
  for (std::uint64_t i = 0; i < 1'000; ++i) {
    const AreaShare share = {1, std::exp2(8 * random_unit(3, i) - 4)};
    (i % 3 == 0 ? one : other).add(share);
    both.add(share);
  }
  one.add(other);
  EXPECT_EQ(one.distortion().p50, both.distortion().p50);
  EXPECT_EQ(one.distortion().p99, both.distortion().p99);
  EXPECT_EQ(one.distortion().max, both.distortion().max);
  EXPECT_NEAR(one.distortion().extra_levels_mean, both.distortion().extra_levels_mean, 1e-12);
}

TEST(Distortion, RatiosBeyondAllBinsCountInTheLast) {
  const Distortion distortion = summarise({{1, 1e-300}, {1, 1e300}});
  EXPECT_EQ(distortion.p50, 1e300);
  EXPECT_EQ(distortion.max, 1e300);
}

TEST(Distortion, ExtraLevelsCountPowersOfFour) {
  const Distortion distortion = summarise({{50, 1}, {25, 16}, {25, 0.01}});
  EXPECT_DOUBLE_EQ(distortion.extra_levels_mean, 0.5);  // where the map is too large no leaf is deeper
  EXPECT_DOUBLE_EQ(distortion.extra_levels_max, 2);
}

TEST(Distortion, IsRelativeToEachChart) {
  const std::vector<Vec2d> even = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Chart chart{.disc = two_triangles(), .uv = even};
  Chart large = chart;
  for (Vec3d& p : large.disc.positions) p *= 10;
  const Chart evenly[] = {chart, large};
  EXPECT_DOUBLE_EQ(measure_distortion(evenly).max, 1) << "both are mapped evenly, however large they are";
  // Half of the chart gets half of its share of the square.
  chart.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0.5}};
  EXPECT_DOUBLE_EQ(measure_distortion({&chart, 1}).max, 2);
}

}  // namespace
}  // namespace curvecast
