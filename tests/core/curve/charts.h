// Charts of generated shapes, for the tests of the curve.
#pragma once

#include <gtest/gtest.h>

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
  double surface = 0;
  for (std::size_t t = 0; t < chart.area_ratio.size(); ++t) {
    const Triangle& v = chart.disc.triangles[t];
    const Vec2d p = chart.uv[v[1]] - chart.uv[v[0]], q = chart.uv[v[2]] - chart.uv[v[0]];
    surface += 0.5 * (p.x() * q.y() - p.y() * q.x()) * chart.area_ratio[t];
  }
  std::vector<double> demand;
  for (const double ratio : chart.area_ratio) demand.push_back(vertices * ratio / surface);
  return demand;
}

}  // namespace curvecast::testing
