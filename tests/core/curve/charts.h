// Charts of generated shapes, for the tests of the curve.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "core/curve/adaptive_quadtree.h"
#include "core/flatten/distortion.h"
#include "core/flatten/flatten.h"
#include "tests/support/shapes.h"

namespace curvecast::testing {

inline std::vector<Chart> charts_of(const TriangleMesh& mesh) {
  FlattenTimes times;
  absl::StatusOr<std::vector<Chart>> charts = flatten(mesh, {}, {}, times);
  EXPECT_TRUE(charts.ok()) << charts.status().message();
  return *std::move(charts);
}

/// Curve vertices per uv area that make `vertices` of them, evenly over the surface.
inline std::vector<double> even_demand(const Chart& chart, double vertices) {
  const double surface = surface_area(chart.disc);
  std::vector<double> demand;
  for (std::size_t t = 0; t < chart.disc.face_count(); ++t) {
    demand.push_back(vertices * area_ratio({chart.disc, chart.uv}, t) / surface);
  }
  return demand;
}

/// The square itself as a chart, n x n cells of two triangles each, which `place` puts into space.
inline Chart grid_chart(std::uint32_t n, const std::function<Vec3d(const Vec2d& uv)>& place) {
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> triangles;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) positions.emplace_back(x, y, 0);
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x;
      triangles.push_back({v, v + 1, v + n + 2});
      triangles.push_back({v, v + n + 2, v + n + 1});
    }
  }
  Chart chart;
  static_cast<TriangleMesh&>(chart.disc) = make_mesh(soup_of(std::move(positions), triangles));
  chart.disc.face_of.resize(chart.disc.face_count());
  std::iota(chart.disc.face_of.begin(), chart.disc.face_of.end(), 0u);
  for (Vec3d& p : chart.disc.positions) {
    chart.uv.emplace_back(p.head<2>() / n);
    p = place(chart.uv.back());
  }
  return chart;
}

/// Leaves where one vertex per uv area is wanted as often as demand(uv) says at a triangle's middle.
inline QuadtreeLeaves leaves_of(const Chart& chart, const std::function<double(const Vec2d& uv)>& demand) {
  std::vector<double> demands;
  for (const Triangle& t : chart.disc.triangles) {
    demands.push_back(demand((chart.uv[t[0]] + chart.uv[t[1]] + chart.uv[t[2]]) / 3));
  }
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(parameter_triangles(chart), demands, 10'000'000);
  EXPECT_TRUE(leaves.ok()) << leaves.status();
  return *std::move(leaves);
}

/// A demand for coarse leaves, and for finer and finer ones the nearer to a place.
inline double graded_demand(const Vec2d& uv) { return 20 / ((uv - Vec2d(0.3, 0.6)).squaredNorm() + 1e-4); }

}  // namespace curvecast::testing
