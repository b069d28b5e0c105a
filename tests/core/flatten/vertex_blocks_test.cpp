#include "core/flatten/vertex_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/flatten/vertex_hierarchy.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using testing::make_mesh;

/// Looks at every vertex and its neighbours.
void expect_seams(const VertexBlocks& blocks, const VertexHierarchy& hierarchy) {
  const auto is_on_seam = [&](std::uint32_t v) {
    bool is_on = false;
    hierarchy.for_each_neighbour(v, [&](std::uint32_t x) { is_on |= blocks.block(x) != blocks.block(v); });
    return is_on;
  };
  for (const std::uint32_t v : hierarchy.base()) {
    bool is_near = false;
    hierarchy.for_each_neighbour(v, [&](std::uint32_t x) { is_near |= is_on_seam(x); });
    const VertexBlocks::Seam wanted = is_on_seam(v) ? VertexBlocks::kOn : is_near ? VertexBlocks::kNear : VertexBlocks::kAway;
    ASSERT_EQ(blocks.seam(v), wanted) << v;
    ASSERT_EQ(blocks.is_away(v), wanted == VertexBlocks::kAway) << v;
  }
}

TEST(VertexBlocks, AreOfTheSameSizeWithSeamsBetweenThem) {
  const TriangleMesh mesh = make_mesh(testing::icosphere(5));
  const VertexHierarchy hierarchy(mesh, {});
  VertexBlocks blocks;
  EXPECT_EQ(blocks.count(), 1u);
  for (const std::uint32_t count : {16u, 4u, 2u}) {  // made, then joined
    blocks.set_count(count, hierarchy, mesh.positions);
    ASSERT_EQ(blocks.count(), count);
    std::vector<std::size_t> sizes(count);
    for (const std::uint32_t v : hierarchy.base()) ++sizes.at(blocks.block(v));
    EXPECT_LE(*std::max_element(sizes.begin(), sizes.end()) - *std::min_element(sizes.begin(), sizes.end()), 16u);
    expect_seams(blocks, hierarchy);
  }
  blocks.set_count(1, hierarchy, mesh.positions);
  EXPECT_EQ(blocks.count(), 1u);
}

TEST(VertexBlocks, AreWantedWhereTheyAreLarge) {
  EXPECT_EQ(VertexBlocks::wanted(1), 1u);
  EXPECT_EQ(VertexBlocks::wanted(20'000), 1u);
  EXPECT_EQ(VertexBlocks::wanted(70'000), 4u);
  EXPECT_EQ(VertexBlocks::wanted(100'000'000), 16u);
}

}  // namespace
}  // namespace curvecast
