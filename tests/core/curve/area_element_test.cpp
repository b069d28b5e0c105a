#include "core/curve/area_element.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using testing::charts_of;
using testing::even_demand;
using testing::make_mesh;

TEST(AreaElement, AddsUpToTheSurface) {
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5), perforated_slab(5, 3)}) {
    const TriangleMesh mesh = make_mesh(soup);
    double sum = 0;
    for (const Chart& chart : charts_of(mesh)) {
      for (const double vertices : {300.0, 30'000.0}) {  // leaves larger and smaller than triangles
        absl::StatusOr<QuadtreeLeaves> leaves =
            build_quadtree(parameter_triangles(chart), even_demand(chart, vertices), 1'000'000);
        ASSERT_TRUE(leaves.ok());
        std::vector<float> area(leaves->size());
        area_elements(parameter_triangles(chart), *leaves, area);
        sum = 0;
        for (const float a : area) {
          EXPECT_GE(a, 0);
          sum += static_cast<double>(a);
        }
        EXPECT_NEAR(sum, surface_area(mesh), 1e-7 * sum);  // each element is a float
      }
    }
  }
}

TEST(AreaElement, MatchesPointCounts) {
  // The share of a fine grid's points in each triangle, leaf by leaf, is the area up to the grid's fineness.
  const TriangleMesh mesh = make_mesh(testing::jittered(testing::sphere(8, 10), 0.05));
  const Chart chart = std::move(charts_of(mesh)[0]);
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), even_demand(chart, 60), 1'000'000);
  ASSERT_TRUE(leaves.ok());
  std::vector<float> area(leaves->size());
  area_elements(parameter_triangles(chart), *leaves, area);
  constexpr int kGrid = 60;
  for (std::size_t l = 0; l < leaves->size(); ++l) {
    const Quad quad = leaf_quad(leaves->key[l], leaves->level[l]);
    double sum = 0;
    double largest = 0;
    for (int y = 0; y < kGrid; ++y) {
      for (int x = 0; x < kGrid; ++x) {
        const Vec2d p = quad.corner + quad.side / kGrid * Vec2d(x + 0.5, y + 0.5);
        for (std::uint32_t t = 0; t < chart.disc.triangles.size(); ++t) {
          const Triangle& v = chart.disc.triangles[t];
          const auto left = [&](const Vec2d& a, const Vec2d& b) {
            return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x() >= 0;
          };
          if (left(chart.uv[v[0]], chart.uv[v[1]]) && left(chart.uv[v[1]], chart.uv[v[2]]) &&
              left(chart.uv[v[2]], chart.uv[v[0]])) {
            const double ratio = area_ratio({chart.disc, chart.uv}, t);
            sum += ratio;
            largest = std::max(largest, ratio);
            break;
          }
        }
      }
    }
    const double cell = quad.side * quad.side / (kGrid * kGrid);
    EXPECT_NEAR(area[l], sum * cell, 6 * kGrid * cell * largest) << "leaf " << l;
  }
}

}  // namespace
}  // namespace curvecast
