#include "core/curve/raise_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "core/curve/leaf_cursor.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 4096;  // leaves whose children one task writes

/// Leaves [begin, end) of a disc; their children begin at `at`.
struct Block {
  std::size_t disc, begin, end, at;
};

int levels_of(const SurfaceCurve& curve, std::size_t l, int levels) { return std::min(levels, kMaxLevel - curve.level[l]); }

/// The last block is empty: where the children end.
std::vector<Block> blocks_of(const SurfaceCurve& curve, int levels) {
  std::vector<Block> blocks;
  std::size_t at = 0;
  for (std::size_t d = 0; d + 1 < curve.disc_begin.size(); ++d) {
    for (std::size_t begin = curve.disc_begin[d]; begin < curve.disc_begin[d + 1]; begin += kBlock) {
      const std::size_t end = std::min<std::size_t>(begin + kBlock, curve.disc_begin[d + 1]);
      blocks.push_back({d, begin, end, at});
      for (std::size_t l = begin; l < end; ++l) at += std::size_t{1} << 2 * levels_of(curve, l, levels);
    }
  }
  blocks.push_back({curve.disc_begin.size() - 1, curve.size(), curve.size(), at});
  return blocks;
}

/// Key, level and area of all children of a block's leaves, and the triangle under each.
void divide(const CurveBase& base, const SurfaceCurve& curve, int levels, const Block& block, SurfaceCurve& out,
            std::span<std::uint32_t> under) {
  const ParameterMesh mesh = base.mesh_of(block.disc);
  LeafCursor cursor;
  std::size_t i = block.at;
  for (std::size_t l = block.begin; l < block.end; ++l) {
    const int down = levels_of(curve, l, levels);
    const int level = curve.level[l] + down;
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - level);
    const float area = std::ldexp(curve.area[l], -2 * down);
    // Every parent starts from its own triangle, so that the ends of the blocks show nowhere.
    std::uint32_t triangle = base.triangle_of[curve.triangle[l]];
    const std::uint64_t end = curve.key[l] + (step << 2 * down);
    for (std::uint64_t key = curve.key[l]; key != end; key += step, ++i) {
      const LeafCursor::Square square = cursor(key, level);
      triangle = find_triangle(mesh, {square.x + 0.5 * square.side, square.y + 0.5 * square.side}, triangle);
      under[i] = triangle;
      out.key[i] = key;
      out.level[i] = static_cast<std::uint8_t>(level);
      out.area[i] = area;
    }
  }
}

}  // namespace

SurfaceCurve raise_levels(const CurveBase& base, const SurfaceCurve& curve, int levels) {
  SurfaceCurve out = next_revision(curve);
  const std::vector<Block> blocks = blocks_of(curve, levels);
  const std::size_t total = blocks.back().at;
  out.resize(total, base.data.colour != nullptr);
  Column<std::uint32_t> under;
  under.resize(total);
  tbb::parallel_for(std::size_t{0}, blocks.size() - 1,
                    [&](std::size_t i) { divide(base, curve, levels, blocks[i], out, under); });
  for (const Block& block : blocks) {
    // Every disc has a leaf, and so a block.
    if (out.disc_begin.size() <= block.disc) out.disc_begin.push_back(static_cast<std::uint32_t>(block.at));
  }
  for (std::size_t d = 0; d < base.charts.size(); ++d) {
    const std::size_t begin = out.disc_begin[d], count = out.disc_begin[d + 1] - begin;
    QuadtreeLeaves leaves;  // the mapper needs no lists of triangles, and finds keys and levels where it writes them
    leaves.key = Column<std::uint64_t>::view({out.key.data() + begin, count}, nullptr);
    leaves.level = Column<std::uint8_t>::view({out.level.data() + begin, count}, nullptr);
    map_to_surface(base.data, base.charts[d], base.triangles[d], leaves, {under.data() + begin, count}, begin, out);
  }
  if (total == curve.size() << 2 * levels) out.max_points = curve.max_points << 2 * levels;
  return out;
}

}  // namespace curvecast
