#include "core/curve/triangle_bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/curve/locate_triangle.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 16'384;  // triangles that are sorted in one go

/// Calls `visit` with every cell that the triangle meets.
template <typename Visit>
void visit_cells(const ParameterTriangle& p, int level, Visit&& visit) {
  const double cells = std::ldexp(1.0, level);
  const auto first = [&](double low) { return static_cast<int>(std::max(std::ceil(low * cells) - 1, 0.0)); };
  const auto last = [&](double high) { return static_cast<int>(std::min(std::floor(high * cells), cells - 1)); };
  const int x0 = first(std::min({p.u[0], p.u[1], p.u[2]})), x1 = last(std::max({p.u[0], p.u[1], p.u[2]}));
  const int y0 = first(std::min({p.v[0], p.v[1], p.v[2]})), y1 = last(std::max({p.v[0], p.v[1], p.v[2]}));
  const bool alone = x0 == x1 && y0 == y1;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      if (alone || touches(p, {Vec2d(x / cells, y / cells), 1 / cells})) visit((static_cast<std::size_t>(y) << level) + x);
    }
  }
}

}  // namespace

std::vector<std::vector<std::uint32_t>> bin_triangles(std::span<const ParameterTriangle> triangles, int level) {
  const std::size_t cells = std::size_t{1} << 2 * level;
  const std::size_t blocks = (triangles.size() + kBlock - 1) / kBlock;
  // First counted, then written: block b of a cell's list begins where the blocks before it end.
  std::vector<std::vector<std::uint32_t>> begin(blocks, std::vector<std::uint32_t>(cells, 0));
  const auto each = [&](std::size_t b, auto&& visit) {
    for (std::size_t t = b * kBlock; t < std::min((b + 1) * kBlock, triangles.size()); ++t) {
      visit_cells(triangles[t], level, [&](std::size_t cell) { visit(cell, static_cast<std::uint32_t>(t)); });
    }
  };
  tbb::parallel_for(std::size_t{0}, blocks,
                    [&](std::size_t b) { each(b, [&](std::size_t cell, std::uint32_t) { ++begin[b][cell]; }); });
  std::vector<std::vector<std::uint32_t>> lists(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    std::uint32_t total = 0;
    for (std::size_t b = 0; b < blocks; ++b) total += std::exchange(begin[b][cell], total);
    lists[cell].resize(total);
  }
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    each(b, [&](std::size_t cell, std::uint32_t t) { lists[cell][begin[b][cell]++] = t; });
  });
  return lists;
}

}  // namespace curvecast
