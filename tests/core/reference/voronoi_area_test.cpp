#include "core/reference/voronoi_area.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <type_traits>
#include <vector>

#include "core/curve/surface_map.h"
#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

struct Areas {
  std::vector<float> area;
  double sum = 0;
};

Areas voronoi_of(const Chart& chart, const QuadtreeLeaves& leaves) {
  const Column<ParameterTriangle> triangles = parameter_triangles(chart);
  std::vector<std::uint32_t> under(leaves.size());
  locate_centres(triangles, leaves, under);
  std::vector<float> x, y, z;
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
    const Vec3d w = triangles[under[l]].weights(quad.corner.x() + quad.side / 2, quad.corner.y() + quad.side / 2);
    const Triangle& t = chart.disc.triangles[under[l]];
    const auto& places = chart.disc.positions;
    const Vec3f p = (w[0] * places[t[0]] + w[1] * places[t[1]] + w[2] * places[t[2]] - places[0]).cast<float>();
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
  Areas areas;
  areas.area.resize(leaves.size());
  areas.sum = voronoi_areas(chart, triangles, leaves, {x, y, z, under, chart.disc.positions[0]}, areas.area);
  return areas;
}

TEST(VoronoiArea, IsTheCellOfAnEvenGrid) {
  // Squares, rectangles and sheared ones, on which fans of eight triangles would count up to a sixth more.
  for (const double shear : {0.0, 0.3, 0.5, 1.7}) {
    const Chart chart = grid_chart(4, [&](const Vec2d& uv) { return Vec3d(2 * uv.x() + shear * uv.y(), uv.y(), 7); });
    const QuadtreeLeaves leaves = leaves_of(chart, [](const Vec2d&) { return 1000; });  // 32 x 32
    ASSERT_EQ(leaves.size(), 1024u);
    const Areas areas = voronoi_of(chart, leaves);
    EXPECT_NEAR(areas.sum, 2, 1e-6);
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
      const bool is_inside = quad.corner.minCoeff() > 0 && quad.corner.maxCoeff() + quad.side < 1;
      if (is_inside || shear == 0) {
        EXPECT_NEAR(areas.area[l], 2.0 / 1024, 1e-7);
      }
    }
  }
}

TEST(VoronoiArea, FillsThePlaneWhereLeavesDifferInSize) {
  const Chart chart = grid_chart(64, [](const Vec2d& uv) { return Vec3d(uv.x() + 0.4 * uv.y(), 3 * uv.y(), uv.x()); });
  const QuadtreeLeaves leaves = leaves_of(chart, graded_demand);
  const Areas areas = voronoi_of(chart, leaves);
  EXPECT_NEAR(areas.sum, surface_area(chart.disc), 1e-5 * areas.sum);
  for (const float area : areas.area) EXPECT_GT(area, 0);
}

TEST(VoronoiArea, OfLeavesWithoutNeighboursReachesTheBorder) {
  const Chart chart = grid_chart(2, [](const Vec2d& uv) { return Vec3d(uv.x(), 2 * uv.y(), 0); });
  for (const double demand : {1.0, 4.0, 16.0}) {
    const QuadtreeLeaves leaves = leaves_of(chart, [&](const Vec2d&) { return demand; });
    ASSERT_EQ(static_cast<double>(leaves.size()), demand);
    const Areas areas = voronoi_of(chart, leaves);
    for (const float area : areas.area) EXPECT_NEAR(area, 2 / demand, 1e-5);
  }
}

/// All but one. Where no triangle lies beneath a leaf, a quadtree goes without it.
QuadtreeLeaves without(const QuadtreeLeaves& leaves, std::size_t gone) {
  const auto rest = [&](const auto& values) {
    std::decay_t<decltype(values)> out;
    out.resize(leaves.size() - 1);
    for (std::size_t l = 0, to = 0; l < leaves.size(); ++l) {
      if (l != gone) out[to++] = values[l];
    }
    return out;
  };
  std::vector<std::uint32_t> begin = {0}, triangles;
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    if (l == gone) continue;
    for (const std::uint32_t t : leaves.triangles_of(l)) triangles.push_back(t);
    begin.push_back(static_cast<std::uint32_t>(triangles.size()));
  }
  return {rest(leaves.key), rest(leaves.level),           rest(leaves.x),
          rest(leaves.y),   Column<std::uint32_t>(begin), Column<std::uint32_t>(triangles)};
}

TEST(VoronoiArea, GapsAmongLeavesBelongToNobody) {
  const Chart chart = grid_chart(4, [](const Vec2d& uv) { return Vec3d(2 * uv.x() + 0.3 * uv.y(), uv.y(), 7); });
  const QuadtreeLeaves even = leaves_of(chart, [](const Vec2d&) { return 16; });
  ASSERT_EQ(even.size(), 16u);
  for (std::size_t gone = 0; gone < even.size(); ++gone) {
    EXPECT_NEAR(voronoi_of(chart, without(even, gone)).sum, 2 * 15 / 16.0, 1e-6) << gone;
  }
  const Chart finer = grid_chart(64, [](const Vec2d& uv) { return Vec3d(uv.x(), 3 * uv.y(), uv.x()); });
  const QuadtreeLeaves graded = leaves_of(finer, graded_demand);
  for (std::size_t gone = 0; gone < graded.size(); gone += 1 + graded.size() / 200) {
    const Areas areas = voronoi_of(finer, without(graded, gone));
    EXPECT_NEAR(areas.sum, surface_area(finer.disc), 0.1 * areas.sum) << gone;
    for (const float area : areas.area) EXPECT_GE(area, 0);
  }
}

TEST(VoronoiArea, AddsUpToCurvedSurfaces) {
  for (const PolygonSoup& soup :
       {jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5), perforated_slab(5, 3)}) {
    const TriangleMesh mesh = make_mesh(soup);
    double sum = 0;
    for (const Chart& chart : charts_of(mesh)) {
      absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), even_demand(chart, 100'000), 10'000'000);
      ASSERT_TRUE(leaves.ok());
      sum += voronoi_of(chart, *leaves).sum;
    }
    EXPECT_NEAR(sum, surface_area(mesh), 0.005 * sum);
  }
}

TEST(VoronoiArea, IsTheSameForAnyNumberOfThreads) {
  const Chart chart = std::move(charts_of(make_mesh(torus(24, 12)))[0]);
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), even_demand(chart, 30'000), 10'000'000);
  ASSERT_TRUE(leaves.ok());
  tbb::task_arena one(1), four(4);
  const Areas a = one.execute([&] { return voronoi_of(chart, *leaves); }),
              b = four.execute([&] { return voronoi_of(chart, *leaves); });
  EXPECT_EQ(a.sum, b.sum);
  EXPECT_EQ(a.area, b.area);
}

}  // namespace
}  // namespace curvecast
