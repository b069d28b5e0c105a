#include "core/reference/id_buffer.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "core/curve/surface_map.h"
#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr double kRounding = 1e-9;  // in barycentric coordinates

struct Located {
  std::vector<std::uint32_t> under;
  IdBufferCounts counts;
};

Located locate(IdBuffer& buffer, const Chart& chart, const QuadtreeLeaves& leaves) {
  Located located;
  located.under.assign(leaves.size(), kNone);
  const absl::Status status = buffer.locate(chart, parameter_triangles(chart), leaves, located.under, {}, &located.counts);
  EXPECT_TRUE(status.ok()) << status;
  return located;
}

/// As the exact mapper has it; where they differ the centre lies in both, on a common edge.
void expect_exact(const Chart& chart, const QuadtreeLeaves& leaves, const std::vector<std::uint32_t>& under) {
  const Column<ParameterTriangle> triangles = parameter_triangles(chart);
  std::vector<std::uint32_t> exact(leaves.size());
  locate_centres(triangles, leaves, exact);
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    if (under[l] == exact[l]) continue;
    ASSERT_LT(under[l], triangles.size());
    const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
    const double u = quad.corner.x() + quad.side / 2, v = quad.corner.y() + quad.side / 2;
    for (const std::uint32_t t : {under[l], exact[l]}) ASSERT_NEAR(triangles[t].weights(u, v).minCoeff(), 0, kRounding);
  }
}

std::unique_ptr<IdBuffer> make_buffer() {
  absl::StatusOr<std::unique_ptr<IdBuffer>> buffer = IdBuffer::create();
  EXPECT_TRUE(buffer.ok()) << buffer.status();
  return *std::move(buffer);
}

TEST(IdBuffer, FindsWhatTheExactMapperFinds) {
  const std::unique_ptr<IdBuffer> buffer = make_buffer();  // one for all discs, large and small
  for (const PolygonSoup& soup : {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5),
                                  perforated_slab(5, 3), single_triangle(), icosphere(5)}) {
    for (const Chart& chart : charts_of(make_mesh(soup))) {
      for (const double vertices : {1.0, 300.0, 30'000.0}) {
        absl::StatusOr<QuadtreeLeaves> leaves =
            build_quadtree(parameter_triangles(chart), even_demand(chart, vertices), 10'000'000);
        ASSERT_TRUE(leaves.ok());
        const Located located = locate(*buffer, chart, *leaves);
        expect_exact(chart, *leaves, located.under);
        EXPECT_LE(located.counts.searched, located.counts.walked);
        if (leaves->size() < 10'000) continue;
        EXPECT_GT(located.counts.sections, 0u);
        EXPECT_LT(located.counts.walked, leaves->size() / 2) << "the pictures are of no use";
      }
    }
  }
}

TEST(IdBuffer, IsExactAtDeepLevels) {
  // A grid that is finer and finer towards its middle, where a cell's side is about 2^-27.
  const auto squeeze = [](double t) { return 0.5 + 16 * std::pow(t - 0.5, 5); };
  Chart chart = grid_chart(41, [](const Vec2d& uv) { return Vec3d(uv.x(), uv.y(), 0); });
  for (Vec2d& uv : chart.uv) {
    uv = Vec2d(squeeze(uv.x()), squeeze(uv.y()));
    for (double& c : uv) c = std::abs(c) < 1e-3 ? 0 : std::abs(c - 1) < 1e-3 ? 1 : c;
  }
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), even_demand(chart, 6'000), 10'000'000);
  ASSERT_TRUE(leaves.ok());
  ASSERT_GE(*std::max_element(leaves->level.begin(), leaves->level.end()), 20);
  const Located located = locate(*make_buffer(), chart, *leaves);
  expect_exact(chart, *leaves, located.under);
  EXPECT_GT(located.counts.sections, 1u);
}

TEST(IdBuffer, TellsMoreThan65536TrianglesApart) {
  const Chart chart = grid_chart(300, [](const Vec2d& uv) { return Vec3d(uv.x(), uv.y(), 0); });
  ASSERT_GT(chart.disc.face_count(), 2u << 16);
  const QuadtreeLeaves leaves = leaves_of(chart, [](const Vec2d&) { return 250'000; });
  const Located located = locate(*make_buffer(), chart, leaves);
  expect_exact(chart, leaves, located.under);
  EXPECT_GT(*std::max_element(located.under.begin(), located.under.end()), 2u << 16);
}

TEST(IdBuffer, IsTheSameForAnyNumberOfThreadsAndOnAnyThread) {
  const Chart chart = std::move(charts_of(make_mesh(torus(24, 12)))[0]);
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), even_demand(chart, 30'000), 10'000'000);
  ASSERT_TRUE(leaves.ok());
  const std::unique_ptr<IdBuffer> buffer = make_buffer();
  tbb::task_arena one(1), four(4);
  const Located a = one.execute([&] { return locate(*buffer, chart, *leaves); });
  const Located b = four.execute([&] { return locate(*buffer, chart, *leaves); });
  Located c;
  std::thread([&] { c = locate(*buffer, chart, *leaves); }).join();
  EXPECT_EQ(a.under, b.under);
  EXPECT_EQ(a.under, c.under);
}

TEST(IdBuffer, StopsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  const Chart chart = grid_chart(4, [](const Vec2d& uv) { return Vec3d(uv.x(), uv.y(), 0); });
  const QuadtreeLeaves leaves = leaves_of(chart, [](const Vec2d&) { return 1000; });
  std::vector<std::uint32_t> under(leaves.size());
  EXPECT_EQ(make_buffer()->locate(chart, parameter_triangles(chart), leaves, under, {.cancel = &cancel}).code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
