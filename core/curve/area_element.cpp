#include "core/curve/area_element.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <functional>

#include "core/base/simd.h"

namespace curvecast {
namespace {

/// The share of a square that a triangle covers, by Green's theorem: the integral of x over y around the triangle, in coordinates
/// in which the square is [0, 1]^2, with y cut off and x clamped there. All sides at once, without jumps: nobody can predict
/// where a side passes a square.
[[gnu::always_inline]] inline double covered_share(const ParameterTriangle& triangle, double x, double y, double scale) {
  // Lanes are the three sides and one of no length. Relative to the square no digits are lost on small leaves.
  const Double4 xa = (Double4{triangle.u[0], triangle.u[1], triangle.u[2], triangle.u[0]} - x) * scale;
  const Double4 ya = (Double4{triangle.v[0], triangle.v[1], triangle.v[2], triangle.v[0]} - y) * scale;
  const Double4 xb = __builtin_shufflevector(xa, xa, 1, 2, 0, 0);
  const Double4 yb = __builtin_shufflevector(ya, ya, 1, 2, 0, 0);
  const Double4 zero{}, one = zero + 1;
  const Double4 rise = yb - ya;
  const Double4 slope = (xb - xa) / (rise != zero ? rise : one);
  Double4 y0 = ya > zero ? ya : zero;
  Double4 y1 = yb > zero ? yb : zero;
  y0 = y0 < one ? y0 : one;
  y1 = y1 < one ? y1 : one;
  const Double4 x0 = xa + slope * (y0 - ya), x1 = xb + slope * (y1 - yb);
  const Double4 low = x0 < x1 ? x0 : x1, high = x0 < x1 ? x1 : x0;
  // The mean of x along the side: what lies between 0 and 1 as a trapezium, and what lies beyond as 1.
  Double4 left = low > zero ? low : zero;
  Double4 right = high > zero ? high : zero;
  left = left < one ? left : one;
  right = right < one ? right : one;
  Double4 beyond = high - (low > one ? low : one);
  beyond = beyond > zero ? beyond : zero;
  const Double4 width = high - low;
  const Double4 mean = width > zero ? (0.5 * (right - left) * (left + right) + beyond) / (width > zero ? width : one) : left;
  const Double4 share = (y1 - y0) * mean;
  return share[0] + share[1] + share[2];
}

/// Writes the elements of leaves [begin, end), and returns their sum before rounding. `full`: the triangles cover the whole
/// square.
CURVECAST_WIDE double write_elements(const ParameterTriangle* triangles, const QuadtreeLeaves& leaves, bool full,
                                     std::size_t begin, std::size_t end, float* area) {
  double total = 0;
  for (std::size_t l = begin; l < end; ++l) {
    const double x = leaves.x[l] * kCellSide, y = leaves.y[l] * kCellSide;
    const double side = side_of_level(leaves.level[l]), scale = 1 / side;
    const std::uint32_t last = leaves.triangle_begin[l + 1] - 1;
    // Where all of the square is covered, the last of a leaf's triangles has what the others leave.
    const std::uint32_t measured = full ? last : last + 1;
    double left = 1;
    double sum = 0;
    for (std::uint32_t i = leaves.triangle_begin[l]; i < measured; ++i) {
      const ParameterTriangle& triangle = triangles[leaves.triangles[i]];
      const double share = fast_clamp(covered_share(triangle, x, y, scale), 0, left);
      sum += share * triangle.area_ratio;
      left -= share;
    }
    if (full) sum += left * triangles[leaves.triangles[last]].area_ratio;
    sum *= side * side;
    area[l] = static_cast<float>(sum);
    total += sum;
  }
  return total;
}

}  // namespace

double area_elements(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<float> area) {
  const bool full = fill_square(triangles);
  const auto write = [&](const tbb::blocked_range<std::size_t>& range, double total) {
    return total + write_elements(triangles.data(), leaves, full, range.begin(), range.end(), area.data());
  };
  // The same order of additions on any number of threads.
  return tbb::parallel_deterministic_reduce(tbb::blocked_range<std::size_t>(0, leaves.size(), 4096), 0.0, write, std::plus<>());
}

void normalise_areas(double total, std::span<float> area) {
  const tbb::blocked_range<std::size_t> all(0, area.size(), 65'536);
  const double sum = tbb::parallel_deterministic_reduce(
      all, 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double partial) {
        for (std::size_t l = range.begin(); l < range.end(); ++l) partial += static_cast<double>(area[l]);
        return partial;
      },
      std::plus<>());
  const double factor = total / sum;
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) area[l] = static_cast<float>(area[l] * factor);
  });
}

}  // namespace curvecast
