#include "core/curve/area_element.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <functional>

#include "core/base/simd.h"
#include "core/curve/covered_share.h"

namespace curvecast {
namespace {

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
  return area_elements(triangles, fill_square(triangles), leaves, area);
}

double area_elements(std::span<const ParameterTriangle> triangles, bool full, const QuadtreeLeaves& leaves,
                     std::span<float> area) {
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
