#include "core/curve/area_element.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "core/curve/leaf_cursor.h"

namespace curvecast {
namespace {

/// The integral of x over y along the segment from (xa, ya) to (xb, yb), of the part where 0 <= y <= 1, with x clamped to [0, 1].
/// Negative where the segment goes down. The same segment backwards gives exactly the opposite.
double clamped_integral(double xa, double ya, double xb, double yb) {
  double sign = 1;
  if (ya > yb) {
    std::swap(xa, xb);
    std::swap(ya, yb);
    sign = -1;
  }
  if (yb <= 0 || ya >= 1 || ya == yb) return 0;
  const double height = std::min(yb, 1.0) - std::max(ya, 0.0);
  if (xa >= 1 && xb >= 1) return sign * height;
  if (xa <= 0 && xb <= 0) return 0;
  const double slope = (xb - xa) / (yb - ya);
  const double x0 = ya < 0 ? xa - slope * ya : xa;
  const double x1 = yb > 1 ? xb - slope * (yb - 1) : xb;
  const double low = std::min(x0, x1), high = std::max(x0, x1);
  if (low >= 1) return sign * height;
  if (high <= 0) return 0;
  if (low >= 0 && high <= 1) return sign * height * 0.5 * (low + high);
  const double left = std::max(low, 0.0), right = std::min(high, 1.0);
  const double sum = 0.5 * (right - left) * (left + right) + std::max(high - 1, 0.0);
  return sign * height * sum / (high - low);
}

/// The share of the square that a triangle covers, by Green's theorem: the boundary integral of x over y. Nothing is clipped, and
/// neighbours get exactly opposite terms for the side that they share.
double covered_share(const ParameterTriangle& triangle, const LeafCursor::Square& square, double scale) {
  double x[3], y[3];
  for (int i = 0; i < 3; ++i) {
    x[i] = (triangle.u[i] - square.x) * scale;  // relative to the square: no digits are lost on small leaves
    y[i] = (triangle.v[i] - square.y) * scale;
  }
  return clamped_integral(x[0], y[0], x[1], y[1]) + clamped_integral(x[1], y[1], x[2], y[2]) +
         clamped_integral(x[2], y[2], x[0], y[0]);
}

}  // namespace

double area_elements(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<float> area) {
  // Where all of the square is covered, the last of a leaf's triangles has what the others leave.
  const bool full = fill_square(triangles);
  const auto write = [&](const tbb::blocked_range<std::size_t>& range, double total) {
    LeafCursor cursor;
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const LeafCursor::Square square = cursor(leaves.key[l], leaves.level[l]);
      const double scale = 1 / square.side;
      const std::span list = leaves.triangles_of(l);
      const std::size_t measured = full ? list.size() - 1 : list.size();
      double left = 1;
      double sum = 0;
      for (std::size_t i = 0; i < measured; ++i) {
        const ParameterTriangle& triangle = triangles[list[i]];
        const double share = std::clamp(covered_share(triangle, square, scale), 0.0, left);
        sum += share * triangle.area_ratio;
        left -= share;
      }
      if (full) sum += left * triangles[list.back()].area_ratio;
      sum *= square.side * square.side;
      area[l] = static_cast<float>(sum);
      total += sum;
    }
    return total;
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
