#include "core/curve/parameter_triangle.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>

namespace curvecast {

Column<ParameterTriangle> parameter_triangles(const Chart& chart) {
  Column<ParameterTriangle> triangles;
  triangles.resize(chart.disc.triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      ParameterTriangle& out = triangles[t];
      for (int i = 0; i < 3; ++i) {
        const Vec2d& corner = chart.uv[chart.disc.triangles[t][i]];
        out.u[i] = corner.x();
        out.v[i] = corner.y();
      }
      out.inverse_area2 = 1 / ((out.u[1] - out.u[0]) * (out.v[2] - out.v[0]) - (out.v[1] - out.v[0]) * (out.u[2] - out.u[0]));
      out.area_ratio = chart.area_ratio[t];
    }
  });
  return triangles;
}

bool fill_square(std::span<const ParameterTriangle> triangles) {
  const double sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double total) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) total += triangles[t].uv_area();
        return total;
      },
      std::plus<>());
  return std::abs(sum - 1) < 1e-9;
}

}  // namespace curvecast
