#include "core/refine/subdivide_all.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "core/base/simd.h"
#include "core/curve/adaptive_quadtree.h"
#include "core/curve/crease_band.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 2048;  // leaves whose children one task writes

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
struct CurveCell {
  HilbertCell cell{0, 0};
  HilbertState state = 0;

  CurveCell child(unsigned i) const {
    const unsigned quadrant = hilbert_quadrant(state, i);
    return {{cell.x << 1 | (quadrant & 1), cell.y << 1 | (quadrant >> 1)}, hilbert_child_state(state, i)};
  }
};

/// Where the centres of the four children lie in a quad of each state, in sides of a child.
struct Centres {
  Double4 x, y;
};

constexpr Centres centres_of(HilbertState state) {
  const auto x = [=](unsigned i) { return (hilbert_quadrant(state, i) & 1) + 0.5; };
  const auto y = [=](unsigned i) { return (hilbert_quadrant(state, i) >> 1) + 0.5; };
  return {Double4{x(0), x(1), x(2), x(3)}, Double4{y(0), y(1), y(2), y(3)}};
}
constexpr Centres kCentres[4] = {centres_of(0), centres_of(1), centres_of(2), centres_of(3)};

/// The places of leaves, faster when asked for in curve order: only where a key differs from the one before does it walk again.
class CellWalk {
 public:
  CurveCell to(std::uint64_t key, int level) {
    const std::uint64_t changed = key ^ key_;
    // The square's own place never changes, and what lies below the last leaf is not known.
    const int same = changed == 0 ? kMaxLevel : kMaxLevel - 1 - (63 - std::countl_zero(changed)) / 2;
    for (int l = std::min(same, level_) + 1; l <= level; ++l) {
      path_[l] = path_[l - 1].child(static_cast<unsigned>(key >> 2 * (kMaxLevel - l)) & 3);
    }
    key_ = key;
    level_ = level;
    return path_[level];
  }

 private:
  std::array<CurveCell, kMaxLevel + 1> path_{};
  std::uint64_t key_ = 0;
  int level_ = 0;
};

/// Writes all children of a block's leaves.
CURVECAST_WIDE void divide(const CurveBase& base, const SurfaceMapper& mapper, const SurfaceCurve& curve, int levels,
                           const Block& block, SurfaceCurve& out) {
  const ParameterMesh mesh = base.mesh_of(block.disc);
  CellWalk walk;
  LeafBatch batch;
  std::size_t at = block.at;  // of the batch's first
  const auto flush = [&] {
    mapper.map(batch, at, out);
    at += batch.count;
    batch.count = 0;
  };
  for (std::size_t l = block.begin; l < block.end; ++l) {
    const int down = levels_of(curve, l, levels);
    const int level = curve.level[l] + down;
    const double side = side_of_level(level);
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - level);
    const float area = curve.area[l] / static_cast<float>(std::uint64_t{1} << 2 * down);
    const auto write = [&](std::size_t i, std::uint64_t key) {
      out.key[i] = key;
      out.level[i] = static_cast<std::uint8_t>(level);
      out.area[i] = area;
    };
    // Every parent starts from its own triangle, so that the ends of the blocks show nowhere.
    std::uint32_t triangle = base.triangle_in(block.disc, curve.triangle[l]);
    const CurveCell parent = walk.to(curve.key[l], curve.level[l]);
    if (down == 0) {
      if (batch.count == LeafBatch::kSize) flush();
      const std::size_t i = batch.count++;
      batch.u[i] = (parent.cell.x + 0.5) * side;
      batch.v[i] = (parent.cell.y + 0.5) * side;
      batch.under[i] = find_triangle(mesh, {batch.u[i], batch.v[i]}, triangle);
      write(at + i, curve.key[l]);
      continue;
    }
    const std::uint64_t groups = std::uint64_t{1} << 2 * (down - 1);  // of four siblings
    for (std::uint64_t g = 0; g < groups; ++g) {
      if (batch.count + 4 > LeafBatch::kSize) flush();
      CurveCell group = parent;
      for (int k = down - 2; k >= 0; --k) group = group.child(static_cast<unsigned>(g >> 2 * k) & 3);
      const std::size_t i = batch.count;
      // In one piece, because they are read in one.
      store_lanes((group.cell.x * 2.0 + kCentres[group.state].x) * side, batch.u + i);
      store_lanes((group.cell.y * 2.0 + kCentres[group.state].y) * side, batch.v + i);
      find_four_triangles(mesh, batch.u + i, batch.v + i, triangle, batch.under + i);
      triangle = batch.under[i + 3];
      for (unsigned k = 0; k < 4; ++k) write(at + i + k, curve.key[l] + (4 * g + k) * step);
      batch.count += 4;
    }
  }
  flush();
  std::size_t child = block.at;
  for (std::size_t l = block.begin; l < block.end && !curve.beside.empty(); ++l) {
    const std::size_t end = child + (std::size_t{1} << 2 * levels_of(curve, l, levels));
    for (; child < end; ++child) out.beside[child] = beside_within(curve, l, out.normal(child));
  }
}

}  // namespace

SurfaceCurve subdivide_all(const CurveBase& base, const SurfaceCurve& curve, int levels) {
  SurfaceCurve out = next_revision(curve);
  const std::vector<Block> blocks = blocks_of(curve, levels);
  const std::size_t total = blocks.back().at;
  out.resize(total, base.data.colour != nullptr, !curve.beside.empty());
  tbb::parallel_for(std::size_t{0}, blocks.size() - 1,
                    [&](std::size_t i) { divide(base, base.mappers[blocks[i].disc], curve, levels, blocks[i], out); });
  for (const Block& block : blocks) {
    // Every disc has a leaf, and so a block.
    if (out.disc_begin.size() <= block.disc) out.disc_begin.push_back(static_cast<std::uint32_t>(block.at));
  }
  if (total == curve.size() << 2 * levels) out.max_points = curve.max_points << 2 * levels;
  return out;
}

}  // namespace curvecast
