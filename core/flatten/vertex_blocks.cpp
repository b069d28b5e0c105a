#include "core/flatten/vertex_blocks.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/flatten/vertex_hierarchy.h"

namespace curvecast {
namespace {

// Blocks at most, a power of two, and the vertices of one: with fewer, too many are near a seam.
constexpr std::uint32_t kMostBlocks = 16;
constexpr std::size_t kLeastBlock = 16384;

}  // namespace

std::uint32_t VertexBlocks::wanted(std::size_t vertices) {
  return std::bit_floor(static_cast<std::uint32_t>(std::clamp<std::size_t>(vertices / kLeastBlock, 1, kMostBlocks)));
}

void VertexBlocks::set_count(std::uint32_t count, const VertexHierarchy& hierarchy, std::span<const Vec3d> positions) {
  const std::vector<std::uint32_t>& vertices = hierarchy.base();
  if (block_.empty() && count > 1) {
    divide(count, vertices, positions);
  } else if (count < count_) {
    const auto joined = static_cast<std::uint8_t>(count_ / count);
    for (const std::uint32_t v : vertices) block_[v] /= joined;
  } else {
    return;
  }
  count_ = count;
  if (count > 1) find_seams(hierarchy);
}

/// Halves along the longest side again and again.
void VertexBlocks::divide(std::uint32_t count, std::span<const std::uint32_t> vertices, std::span<const Vec3d> positions) {
  block_.assign(positions.size(), 0);
  seam_.assign(positions.size(), kAway);
  std::vector<std::uint32_t> order(vertices.begin(), vertices.end());
  const auto halve = [&](const auto& self, std::span<std::uint32_t> part, std::uint32_t first, std::uint32_t blocks) -> void {
    if (blocks == 1) {
      for (const std::uint32_t v : part) block_[v] = static_cast<std::uint8_t>(first);
      return;
    }
    Box3d box;
    for (const std::uint32_t v : part) box.extend(positions[v]);
    int axis = 0;
    (box.max - box.min).maxCoeff(&axis);
    const std::size_t half = part.size() / 2;
    std::nth_element(
        part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
        [&](std::uint32_t v, std::uint32_t w) { return std::pair(positions[v][axis], v) < std::pair(positions[w][axis], w); });
    tbb::parallel_invoke([&] { self(self, part.subspan(0, half), first, blocks / 2); },
                         [&] { self(self, part.subspan(half), first + blocks / 2, blocks / 2); });
  };
  halve(halve, order, 0, count);
}

void VertexBlocks::find_seams(const VertexHierarchy& hierarchy) {
  const std::vector<std::uint32_t>& vertices = hierarchy.base();
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
    const std::uint32_t v = vertices[i];
    seam_[v] = kAway;
    hierarchy.for_each_neighbour(v, [&](std::uint32_t x) {
      if (block_[x] != block_[v]) seam_[v] = kOn;
    });
  });
  for (const std::uint32_t v : vertices) {
    if (seam_[v] == kOn) spread_seams(v, hierarchy);
  }
}

void VertexBlocks::spread_seams(std::uint32_t u, const VertexHierarchy& hierarchy) {
  const auto make_near = [&](std::uint32_t v) { seam_[v] = std::max(seam_[v], kNear); };
  hierarchy.for_each_neighbour(u, [&](std::uint32_t x) {
    if (block_[x] != block_[u]) seam_[u] = kOn;
    if (block_[x] != block_[u] && seam_[x] != kOn) {
      seam_[x] = kOn;
      hierarchy.for_each_neighbour(x, make_near);
    }
    if (seam_[x] == kOn) make_near(u);
  });
  if (seam_[u] == kOn) hierarchy.for_each_neighbour(u, make_near);
}

}  // namespace curvecast
