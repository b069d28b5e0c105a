#include "core/curve/raise_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "core/curve/adaptive_quadtree.h"

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

/// A quad on the way down: its cell at its level, and how the curve lies in it.
struct Place {
  HilbertCell cell{0, 0};
  HilbertState state = 0;

  Place child(unsigned i) const {
    const unsigned quadrant = hilbert_quadrant(state, i);
    return {{cell.x << 1 | (quadrant & 1), cell.y << 1 | (quadrant >> 1)}, hilbert_child_state(state, i)};
  }
};

Place place_of(std::uint64_t key, int level) {
  Place place;
  for (int l = 1; l <= level; ++l) place = place.child(static_cast<unsigned>(key >> 2 * (kMaxLevel - l)) & 3);
  return place;
}

/// What is known of a new leaf besides its key and level, which are written to the curve.
struct Children {
  Column<std::uint32_t> x, y;   // of all, see QuadtreeLeaves
  Column<std::uint32_t> under;  // triangle of the disc under the centre

  void resize(std::size_t n) { x.resize(n), y.resize(n), under.resize(n); }
};

/// All children of a block's leaves.
void divide(const CurveBase& base, const SurfaceCurve& curve, int levels, const Block& block, SurfaceCurve& out,
            Children& children) {
  const ParameterMesh mesh = base.mesh_of(block.disc);
  std::size_t i = block.at;
  for (std::size_t l = block.begin; l < block.end; ++l) {
    const int down = levels_of(curve, l, levels);
    const int level = curve.level[l] + down;
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - level);
    const float area = std::ldexp(curve.area[l], -2 * down);
    // Every parent starts from its own triangle, so that the ends of the blocks show nowhere.
    std::uint32_t triangle = base.triangle_of[curve.triangle[l]];
    const Place parent = place_of(curve.key[l], curve.level[l]);
    const double side = side_of_level(level);
    for (std::uint64_t c = 0; c < std::uint64_t{1} << 2 * down; ++c, ++i) {
      Place place = parent;
      for (int k = down - 1; k >= 0; --k) place = place.child(static_cast<unsigned>(c >> 2 * k) & 3);
      triangle = find_triangle(mesh, {(place.cell.x + 0.5) * side, (place.cell.y + 0.5) * side}, triangle);
      children.x[i] = place.cell.x << (kMaxLevel - level);
      children.y[i] = place.cell.y << (kMaxLevel - level);
      children.under[i] = triangle;
      out.key[i] = curve.key[l] + c * step;
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
  Children children;
  children.resize(total);
  tbb::parallel_for(std::size_t{0}, blocks.size() - 1,
                    [&](std::size_t i) { divide(base, curve, levels, blocks[i], out, children); });
  for (const Block& block : blocks) {
    // Every disc has a leaf, and so a block.
    if (out.disc_begin.size() <= block.disc) out.disc_begin.push_back(static_cast<std::uint32_t>(block.at));
  }
  for (std::size_t d = 0; d < base.charts.size(); ++d) {
    const std::size_t begin = out.disc_begin[d], count = out.disc_begin[d + 1] - begin;
    const auto part = [&]<typename T>(const Column<T>& column) {
      return Column<T>::view({column.data() + begin, count}, nullptr);
    };
    // The mapper needs no lists of triangles, and finds keys and levels where it writes them.
    const QuadtreeLeaves leaves{part(out.key), part(out.level), part(children.x), part(children.y), {}, {}};
    map_to_surface(base.data, base.charts[d], base.triangles[d], leaves, {children.under.data() + begin, count}, begin, out);
  }
  if (total == curve.size() << 2 * levels) out.max_points = curve.max_points << 2 * levels;
  return out;
}

}  // namespace curvecast
