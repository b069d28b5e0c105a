#include "core/flatten/flatten.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string_view>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/minimise_stretch.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

/// Every face lies in one chart, whole; no chart has a flipped triangle.
void expect_complete(const TriangleMesh& mesh, const std::vector<Chart>& charts) {
  std::vector<double> covered(mesh.face_count(), 0.0);
  std::vector<std::size_t> chart_of(mesh.face_count(), charts.size());
  for (std::size_t c = 0; c < charts.size(); ++c) {
    EXPECT_EQ(count_flipped(charts[c].disc, charts[c].uv), 0u);
    for (std::size_t t = 0; t < charts[c].disc.triangles.size(); ++t) {
      const std::uint32_t f = charts[c].disc.face_of[t];
      EXPECT_TRUE(chart_of[f] == charts.size() || chart_of[f] == c);
      chart_of[f] = c;
      const Triangle& v = charts[c].disc.triangles[t];
      const Vec2d p = charts[c].uv[v[1]] - charts[c].uv[v[0]], q = charts[c].uv[v[2]] - charts[c].uv[v[0]];
      covered[f] += 0.5 * (p.x() * q.y() - p.y() * q.x()) * area_ratio({charts[c].disc, charts[c].uv}, t);
    }
  }
  for (std::size_t f = 0; f < covered.size(); ++f) EXPECT_NEAR(covered[f], triangle_area(mesh, f), 1e-9 * covered[f]);
}

std::vector<Chart> flattened(const TriangleMesh& mesh, const FlattenOptions& options = {}) {
  FlattenTimes times;
  absl::StatusOr<std::vector<Chart>> charts = flatten(mesh, options, {}, times);
  EXPECT_TRUE(charts.ok()) << charts.status().message();
  return *std::move(charts);
}

TEST(Flatten, OneChartPerComponent) {
  using namespace testing;
  const TriangleMesh mesh =
      make_mesh(merged(merged(sphere(12, 16), translated(torus(16, 8), {4, 0, 0})), translated(single_triangle(), {9, 0, 0})));
  const std::vector<Chart> charts = flattened(mesh);
  EXPECT_EQ(charts.size(), 3u);
  EXPECT_EQ(charts[0].disc.face_of[0], 0u);
  expect_complete(mesh, charts);
}

TEST(Flatten, DividesWhatWouldStretchTooMuch) {
  // 144 tunnels, which one disc has to open all.
  const TriangleMesh mesh = testing::make_mesh(testing::perforated_slab(25, 25));
  const std::vector<Chart> charts = flattened(mesh);
  EXPECT_GT(charts.size(), 1u);
  EXPECT_LE(charts.size(), mesh.face_count() / 1000);
  expect_complete(mesh, charts);
  const DiscMesh whole = *cut_to_disc(mesh);
  const double undivided = measure_stretch(whole, *minimise_stretch(whole)).total;
  double sum = 0;  // of squares, weighted by area
  for (const Chart& chart : charts) {
    sum += surface_area(chart.disc) * std::pow(measure_stretch(chart.disc, chart.uv).total, 2);
  }
  EXPECT_LT(std::sqrt(sum / surface_area(mesh)), undivided / 2);
}

TEST(Flatten, CgalMakesValidChartsToo) {
  using namespace testing;
  for (const PolygonSoup& soup : {merged(sphere(12, 16), translated(torus(16, 8), {4, 0, 0})), cube(), single_triangle()}) {
    const TriangleMesh mesh = make_mesh(soup);
    expect_complete(mesh, flattened(mesh, {.parameteriser = Parameteriser::kCgal}));
  }
}

TEST(Flatten, HandlesAndHolesByTheHundredAreMappedWithTheLeastStretch) {
  // Closed, of genus 81; and a ball with more than 200 holes.
  const PolygonSoup slab = testing::perforated_slab(19, 19);
  const TriangleMesh handles = testing::make_mesh(slab);
  ASSERT_EQ(analyse_topology(handles).genus, 81u);
  const PolygonSoup ball = testing::icosphere(5);
  const TriangleMesh holes = testing::make_mesh(testing::filtered(ball, [](std::size_t p) { return p % 97 != 0; }));
  ASSERT_GE(analyse_topology(holes).boundary_loops, 200u);
  for (const TriangleMesh* mesh : {&handles, &holes}) {
    const std::vector<Chart> charts = flattened(*mesh);
    EXPECT_LE(charts.size(), mesh->face_count() / 1000);
    for (const Chart& chart : charts) EXPECT_EQ(chart.parameterisation, Parameterisation::kLeastStretch);
    expect_complete(*mesh, charts);
  }
}

TEST(Flatten, ManyComponentsComeInTheirOrderOnAnyNumberOfThreads) {
  PolygonSoup soup = testing::icosphere(2);
  for (int i = 1; i < 60; ++i) {
    soup =
        testing::merged(soup, testing::translated(i % 3 == 0 ? testing::torus(12, 8) : testing::icosphere(2), {4.0 * i, 0, 0}));
  }
  const TriangleMesh mesh = testing::make_mesh(soup);
  std::vector<std::vector<Chart>> results;
  for (const int threads : {1, 4}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(flattened(mesh)); });
  }
  for (const std::vector<Chart>& charts : results) {
    ASSERT_EQ(charts.size(), 60u);
    expect_complete(mesh, charts);
    for (std::size_t c = 1; c < charts.size(); ++c) EXPECT_LT(charts[c - 1].disc.face_of[0], charts[c].disc.face_of[0]);
  }
  for (std::size_t c = 0; c < 60; ++c) EXPECT_EQ(results[0][c].uv, results[1][c].uv);
}

TEST(Flatten, ProgressComesFromOneThreadAtATimeAndNeverGoesBack) {
  PolygonSoup soup = testing::cube();
  for (int i = 1; i < 200; ++i) soup = testing::merged(soup, testing::translated(testing::cube(), {3.0 * i, 0, 0}));
  const TriangleMesh mesh = testing::make_mesh(soup);
  std::atomic<int> inside = 0;
  double last = 0;
  ExecutionContext context;
  context.on_progress = [&](std::string_view, double fraction) {
    EXPECT_EQ(inside.fetch_add(1), 0);
    EXPECT_GE(fraction, last);
    last = fraction;
    --inside;
  };
  FlattenTimes times;
  ASSERT_TRUE(flatten(mesh, {}, context, times).ok());
  EXPECT_EQ(last, 1);
}

TEST(Flatten, DividesWhatIsTooDistorted) {
  const TriangleMesh mesh = testing::make_mesh(testing::open_cylinder(200, 8, 60));
  const FlattenOptions strict{.extremities = {.most = 0}, .max_area_ratio = 1.6};
  const std::vector<Chart> charts = flattened(mesh, strict);
  EXPECT_GT(charts.size(), 1u);
  expect_complete(mesh, charts);
}

TEST(Flatten, LargeComponentsAreDividedAndTheCurveGoesOnWhereItEnded) {
  const FlattenOptions small{.most_whole_faces = 2000, .chart_faces = 1000};
  const TriangleMesh mesh = testing::make_mesh(testing::merged(
      testing::merged(testing::jittered(testing::icosphere(5), 0.005), testing::translated(testing::cube(), {5, 0, 0})),
      testing::translated(testing::torus(40, 80), {9, 0, 0})));
  std::vector<std::vector<Chart>> results;
  for (const int threads : {1, 4}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(flattened(mesh, small)); });
  }
  const std::vector<Chart>& charts = results[0];
  EXPECT_GE(charts.size(), 20u);
  expect_complete(mesh, charts);
  ASSERT_EQ(results[1].size(), charts.size());
  for (std::size_t c = 0; c < charts.size(); ++c) EXPECT_EQ(results[1][c].uv, charts[c].uv);
  const auto place_at = [](const Chart& chart, const Vec2d& corner) {
    const auto found = std::find(chart.uv.begin(), chart.uv.end(), corner);
    EXPECT_NE(found, chart.uv.end());
    return chart.disc.positions[static_cast<std::size_t>(found - chart.uv.begin())];
  };
  // The ball's charts: from one to the next is not farther than across a chart.
  std::size_t near = 0, steps = 0;
  for (std::size_t c = 1; c < charts.size(); ++c) {
    if (charts[c].disc.face_of[0] >= 20'480) break;
    ++steps;
    const double across = std::sqrt(surface_area(charts[c].disc));
    if ((place_at(charts[c - 1], {1, 0}) - place_at(charts[c], {0, 0})).norm() < across) ++near;
  }
  EXPECT_GE(steps, 15u);
  EXPECT_GE(4 * near, 3 * steps);  // entry and exit need not lie a quarter of a border apart
}

TEST(Flatten, PartsWithLimbsAreStillCutToThem) {
  // A plane with a tall, thin spike: without a cut along it the spike's area would be squeezed into next to nothing.
  PolygonSoup soup = testing::square(60);
  for (Vec3d& p : soup.positions) p.z() = 3 * std::exp(-400 * ((p.x() - 0.3) * (p.x() - 0.3) + (p.y() - 0.3) * (p.y() - 0.3)));
  const TriangleMesh mesh = testing::make_mesh(soup);
  const std::vector<Chart> charts = flattened(mesh, {.most_whole_faces = 5000, .chart_faces = 2500});
  EXPECT_GE(charts.size(), 2u);
  expect_complete(mesh, charts);
  for (const Chart& chart : charts) EXPECT_LT(measure_stretch(chart.disc, chart.uv).total, 2.0);
}

TEST(Flatten, FallsBackToSingleTriangles) {
  const TriangleMesh mesh = testing::make_mesh(testing::cube());
  const std::vector<Chart> charts = flattened(mesh, {.max_area_ratio = 1.6});
  expect_complete(mesh, charts);
}

TEST(Flatten, NeedlesAndSpikesStayValid) {
  // A sphere with one vertex pulled far out, and one squeezed to a millionth of its height.
  PolygonSoup spike = testing::sphere(20, 24);
  spike.positions[200] *= 50;
  PolygonSoup flat = testing::sphere(20, 24);
  for (Vec3d& p : flat.positions) p.z() *= 1e-6;
  for (const PolygonSoup& soup : {spike, flat}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    expect_complete(mesh, flattened(mesh));
  }
}

TEST(Flatten, RefusesMorePiecesThanItHasRoomFor) {
  TriangleMesh mesh;
  const auto count = static_cast<std::uint32_t>(kMostComponents + 1);
  for (std::uint32_t f = 0; f < count; ++f) {
    const double x = 2.0 * f;
    for (const Vec3d& p : {Vec3d(x, 0, 0), Vec3d(x + 1, 0, 0), Vec3d(x, 1, 0)}) mesh.positions.push_back(p);
    mesh.triangles.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  mesh.twins.assign(3 * std::size_t{count}, kNone);
  FlattenTimes times;
  const absl::Status status = flatten(mesh, {}, {}, times).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(
      status.message(),
      "the mesh falls into 1000001 pieces that share no edge; at most 1000000 are taken: join them, or leave out small ones");
}

TEST(Flatten, StopsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  FlattenTimes times;
  const TriangleMesh mesh = testing::make_mesh(testing::cube());
  EXPECT_EQ(flatten(mesh, {}, {.cancel = &cancel}, times).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
