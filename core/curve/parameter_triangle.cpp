#include "core/curve/parameter_triangle.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>

namespace curvecast {

Column<ParameterTriangle> parameter_triangles(const ChartView& chart) {
  const ChartTriangles of_chart(chart);
  Column<ParameterTriangle> triangles;
  triangles.resize(of_chart.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) triangles[t] = of_chart.whole(t);
  });
  return triangles;
}

namespace {

template <typename Triangles>
bool fill_square_here(const Triangles& triangles) {
  const double sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double total) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) total += triangles[t].uv_area();
        return total;
      },
      std::plus<>());
  return std::abs(sum - 1) < 1e-9;
}

}  // namespace

bool fill_square(std::span<const ParameterTriangle> triangles) { return fill_square_here(triangles); }
bool fill_square(const ChartTriangles& triangles) { return fill_square_here(triangles); }

}  // namespace curvecast
