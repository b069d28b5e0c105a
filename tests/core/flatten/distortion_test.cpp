#include "core/flatten/distortion.h"

#include <gtest/gtest.h>

#include <vector>

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

TEST(Distortion, AreaRatiosAreSurfaceOverParameterArea) {
  const std::vector<double> ratios = area_ratios(two_triangles(), {{0, 0}, {1, 0}, {1, 1}, {0, 0.5}});
  EXPECT_DOUBLE_EQ(ratios[0], 4);
  EXPECT_DOUBLE_EQ(ratios[1], 8);
}

TEST(Distortion, QuantilesGoByArea) {
  const Distortion distortion = summarise_distortion({{60, 1}, {38.5, 2}, {1, 0.1}, {0.5, 100}});
  EXPECT_DOUBLE_EQ(distortion.p50, 1);
  EXPECT_DOUBLE_EQ(distortion.p99, 10);  // shrinking by 10 counts as 10
  EXPECT_DOUBLE_EQ(distortion.p999, 100);
  EXPECT_DOUBLE_EQ(distortion.max, 100);
  EXPECT_DOUBLE_EQ(distortion.density_p999, 100);
  EXPECT_DOUBLE_EQ(summarise_distortion({{99.95, 1}, {0.05, 100}}).density_p999, 1);
  EXPECT_DOUBLE_EQ(summarise_distortion({{90, 1}, {10, 0.1}}).density_p999, 1);  // spread out, not squeezed
}

TEST(Distortion, ExtraLevelsCountPowersOfFour) {
  const Distortion distortion = summarise_distortion({{50, 1}, {25, 16}, {25, 0.01}});
  EXPECT_DOUBLE_EQ(distortion.extra_levels_mean, 0.5);  // where the map is too large no leaf is deeper
  EXPECT_DOUBLE_EQ(distortion.extra_levels_max, 2);
}

TEST(Distortion, IsRelativeToEachChart) {
  const std::vector<Vec2d> even = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Chart chart{.disc = two_triangles(), .uv = even, .area_ratio = area_ratios(two_triangles(), even)};
  Chart large = chart;
  for (Vec3d& p : large.disc.positions) p *= 10;
  large.area_ratio = area_ratios(large.disc, even);
  const Chart evenly[] = {chart, large};
  EXPECT_DOUBLE_EQ(measure_distortion(evenly).max, 1) << "both are mapped evenly, however large they are";
  // Half of the chart gets half of its share of the square.
  chart.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0.5}};
  chart.area_ratio = area_ratios(chart.disc, chart.uv);
  EXPECT_DOUBLE_EQ(measure_distortion({&chart, 1}).max, 2);
}

}  // namespace
}  // namespace curvecast
