#include "core/curve/adaptive_quadtree.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using testing::charts_of;
using testing::even_demand;
using testing::make_mesh;

constexpr std::size_t kNoLimit = 10'000'000;

std::vector<Chart> sample_charts() {
  using namespace testing;
  std::vector<Chart> charts;
  for (const PolygonSoup& soup : {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5),
                                  perforated_slab(5, 3), single_triangle()}) {
    for (Chart& chart : charts_of(make_mesh(soup))) charts.push_back(std::move(chart));
  }
  return charts;
}

QuadtreeLeaves build(const Chart& chart, const std::vector<double>& demand, std::size_t limit = kNoLimit) {
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), demand, limit);
  EXPECT_TRUE(leaves.ok());
  return *std::move(leaves);
}

TEST(AdaptiveQuadtree, LeavesTileTheSquareInCurveOrder) {
  for (const Chart& chart : sample_charts()) {
    const QuadtreeLeaves leaves = build(chart, even_demand(chart, 20'000));
    ASSERT_EQ(leaves.triangle_begin.size(), leaves.size() + 1);
    std::uint64_t expected = 0;  // each leaf begins where the one before it ended: no gap, no overlap
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      ASSERT_EQ(leaves.key[l], expected);
      expected += std::uint64_t{1} << 2 * (kMaxLevel - leaves.level[l]);
    }
    EXPECT_EQ(expected, std::uint64_t{1} << 2 * kMaxLevel);
  }
}

TEST(AdaptiveQuadtree, ConsecutiveLeavesAreNeighbours) {
  for (const Chart& chart : sample_charts()) {
    const QuadtreeLeaves leaves = build(chart, even_demand(chart, 5'000));
    for (std::size_t l = 1; l < leaves.size(); ++l) {
      const Quad a = leaf_quad(leaves.key[l - 1], leaves.level[l - 1]);
      const Quad b = leaf_quad(leaves.key[l], leaves.level[l]);
      const double touch_x = std::min(a.corner.x() + a.side, b.corner.x() + b.side) - std::max(a.corner.x(), b.corner.x());
      const double touch_y = std::min(a.corner.y() + a.side, b.corner.y() + b.side) - std::max(a.corner.y(), b.corner.y());
      // They share a piece of a side: no distance in one direction, some length in the other.
      EXPECT_EQ(std::min(touch_x, touch_y), 0);
      EXPECT_GT(std::max(touch_x, touch_y), 0);
    }
  }
}

TEST(AdaptiveQuadtree, EveryLeafIsEnoughForItsTrianglesAndNoDeeperThanNeeded) {
  for (const Chart& chart : sample_charts()) {
    const std::vector<double> demand = even_demand(chart, 5'000);
    const QuadtreeLeaves leaves = build(chart, demand);
    const double highest = *std::max_element(demand.begin(), demand.end());
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      const double offered = std::ldexp(1.0, 2 * leaves.level[l]);
      EXPECT_LT(leaves.triangle_begin[l], leaves.triangle_begin[l + 1]);
      for (std::uint32_t i = leaves.triangle_begin[l]; i < leaves.triangle_begin[l + 1]; ++i) {
        EXPECT_LE(demand[leaves.triangles[i]], offered);
      }
      EXPECT_LT(offered, 4 * std::max(highest, 1.0));
    }
  }
}

TEST(AdaptiveQuadtree, ListsEveryTriangleThatReachesIntoALeaf) {
  for (const Chart& chart : sample_charts()) {
    const QuadtreeLeaves leaves = build(chart, even_demand(chart, 500));
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
      const auto first = leaves.triangles.begin() + leaves.triangle_begin[l];
      const auto last = leaves.triangles.begin() + leaves.triangle_begin[l + 1];
      // A triangle reaches in for certain when one of its interior points does.
      for (std::uint32_t t = 0; t < chart.disc.triangles.size(); ++t) {
        const Triangle& v = chart.disc.triangles[t];
        for (const Vec3d& w :
             {Vec3d(0.34, 0.33, 0.33), Vec3d(0.98, 0.01, 0.01), Vec3d(0.01, 0.98, 0.01), Vec3d(0.01, 0.01, 0.98)}) {
          const Vec2d p = w[0] * chart.uv[v[0]] + w[1] * chart.uv[v[1]] + w[2] * chart.uv[v[2]] - quad.corner;
          const bool inside = p.minCoeff() > 0 && p.maxCoeff() < quad.side;
          EXPECT_TRUE(!inside || std::find(first, last, t) != last);
        }
      }
    }
  }
}

TEST(AdaptiveQuadtree, IsTheSameForAnyNumberOfThreads) {
  const Chart chart = std::move(charts_of(make_mesh(testing::sphere(40, 60)))[0]);
  const std::vector<double> demand = even_demand(chart, 200'000);
  tbb::task_arena one(1), four(4);
  const QuadtreeLeaves a = one.execute([&] { return build(chart, demand); });
  const QuadtreeLeaves b = four.execute([&] { return build(chart, demand); });
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.level, b.level);
  EXPECT_EQ(a.triangle_begin, b.triangle_begin);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(AdaptiveQuadtree, StaysWithinItsLimit) {
  const Chart chart = std::move(charts_of(make_mesh(testing::sphere(20, 30)))[0]);
  std::vector<double> demand = even_demand(chart, 10'000);
  demand[5] = 1e12;
  const QuadtreeLeaves leaves = build(chart, demand, 100'000);
  EXPECT_LE(leaves.size(), 100'000u);
  EXPECT_GE(leaves.size(), 10'000u);
}

TEST(AdaptiveQuadtree, AsksBeforeThereAreMoreLeaves) {
  const Chart chart = std::move(charts_of(make_mesh(testing::sphere(20, 30)))[0]);
  const Column<ParameterTriangle> triangles = parameter_triangles(chart);
  const std::vector<double> demand = even_demand(chart, 500'000);
  std::vector<std::size_t> asked;
  const auto note = [&](std::size_t leaves) {
    asked.push_back(leaves);
    return absl::OkStatus();
  };
  const absl::StatusOr<QuadtreeLeaves> all = build_quadtree(triangles, demand, kNoLimit, {}, note);
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_GT(asked.size(), 1u) << "step by step";
  EXPECT_EQ(std::ranges::adjacent_find(asked, std::ranges::greater_equal()), asked.end());
  EXPECT_EQ(asked.back(), all->size());
  std::size_t most = 0;
  const auto refuse = [&](std::size_t leaves) {
    most = leaves;
    return leaves > 200'000 ? absl::ResourceExhaustedError("no more") : absl::OkStatus();
  };
  EXPECT_EQ(build_quadtree(triangles, demand, kNoLimit, {}, refuse).status(), absl::ResourceExhaustedError("no more"));
  EXPECT_LT(most, 300'000u) << "it was not asked again";
}

TEST(AdaptiveQuadtree, StopsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  const Chart chart = std::move(charts_of(make_mesh(testing::sphere(20, 30)))[0]);
  EXPECT_EQ(
      build_quadtree(parameter_triangles(chart), even_demand(chart, 100'000), kNoLimit, {.cancel = &cancel}).status().code(),
      absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
