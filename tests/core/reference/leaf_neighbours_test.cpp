#include "core/reference/leaf_neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/random.h"
#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr std::uint32_t kCells = std::uint32_t{1} << kMaxLevel;

QuadtreeLeaves graded_leaves() {
  return leaves_of(grid_chart(64, [](const Vec2d& uv) { return Vec3d(uv.x(), uv.y(), 0); }), graded_demand);
}

/// A leaf's square in cells.
struct Square {
  std::int64_t x, y, side;
};

Square square_of(const LeafKeys& leaves, std::size_t l) {
  const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
  return {static_cast<std::int64_t>(quad.corner.x() * kCells), static_cast<std::int64_t>(quad.corner.y() * kCells),
          static_cast<std::int64_t>(quad.side * kCells)};
}

std::uint32_t leaf_by_search(const LeafKeys& leaves, std::int64_t x, std::int64_t y) {
  for (std::uint32_t l = 0; l < leaves.key.size(); ++l) {
    const Square s = square_of(leaves, l);
    if (x >= s.x && x < s.x + s.side && y >= s.y && y < s.y + s.side) return l;
  }
  return kNone;
}

/// Where every cell of the square is in a leaf: the leaf with the last key that is not above the cell's.
std::uint32_t leaf_by_key(const LeafKeys& leaves, HilbertCell cell) {
  const auto above = std::upper_bound(leaves.key.begin(), leaves.key.end(), hilbert_index(cell, kMaxLevel));
  return static_cast<std::uint32_t>(above - leaves.key.begin()) - 1;
}

void expect_neighbours_as_by_search(const LeafKeys& keys, std::size_t step) {
  for (std::uint32_t l = 0; l < keys.key.size(); l += static_cast<std::uint32_t>(step)) {
    const Square s = square_of(keys, l);
    const std::int64_t left = s.x - 1, middle_x = s.x + s.side / 2, right = s.x + s.side;
    const std::int64_t below = s.y - 1, middle_y = s.y + s.side / 2, above = s.y + s.side;
    const std::pair<std::int64_t, std::int64_t> places[] = {{right, middle_y}, {right, above}, {middle_x, above}, {left, above},
                                                            {left, middle_y},  {left, below},  {middle_x, below}, {right, below}};
    const std::array<std::uint32_t, 8> neighbours = leaf_neighbours(keys, l);
    for (std::size_t i = 0; i < 8; ++i) {
      ASSERT_EQ(neighbours[i], leaf_by_search(keys, places[i].first, places[i].second)) << "leaf " << l << ", " << i;
    }
  }
}

TEST(LeafNeighbours, AreTheLeavesBeyondSidesAndCorners) {
  const QuadtreeLeaves leaves = graded_leaves();
  EXPECT_GT(*std::max_element(leaves.level.begin(), leaves.level.end()),
            *std::min_element(leaves.level.begin(), leaves.level.end()) + 3);
  expect_neighbours_as_by_search({leaves.key, leaves.level}, 7);
}

TEST(LeafNeighbours, AreNoneWhereLeavesAreMissing) {
  const QuadtreeLeaves leaves = graded_leaves();
  std::vector<std::uint64_t> key;
  std::vector<std::uint8_t> level;
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    if (random_unit(2, l) < 0.4) continue;
    key.push_back(leaves.key[l]);
    level.push_back(leaves.level[l]);
  }
  expect_neighbours_as_by_search({key, level}, 7);
}

TEST(LeafNeighbours, OfTheDeepestLevelAndOfTheWholeSquare) {
  // Four leaves of the deepest level in the lower left corner, and what is left around them.
  std::vector<std::uint64_t> key = {0, 1, 2, 3};
  std::vector<std::uint8_t> level(4, kMaxLevel);
  for (int l = kMaxLevel - 1; l > 0; --l) {
    for (std::uint64_t i = 1; i < 4; ++i) {
      key.push_back(i << 2 * (kMaxLevel - l));
      level.push_back(static_cast<std::uint8_t>(l));
    }
  }
  expect_neighbours_as_by_search({key, level}, 1);
  const std::vector<std::uint64_t> whole = {0};
  const std::vector<std::uint8_t> top = {0};
  for (const std::uint32_t neighbour : leaf_neighbours({whole, top}, 0)) EXPECT_EQ(neighbour, kNone);
}

TEST(LeafRing, GoesAroundTheLeafWithoutGaps) {
  const QuadtreeLeaves leaves = graded_leaves();
  const LeafKeys keys{leaves.key, leaves.level};
  std::vector<RingEntry> ring;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> touching;
  for (std::uint32_t l = 0; l < leaves.size(); ++l) {
    const Square s = square_of(keys, l);
    const HilbertCell cell = leaf_ring(keys, l, ring);
    EXPECT_EQ(cell.x, s.x);
    EXPECT_EQ(cell.y, s.y);
    std::int64_t along = 0;  // the leaf's border that its ring touches
    int corners = 0;
    for (const RingEntry& entry : ring) {
      corners += entry.is_corner;
      const bool is_outside = entry.cell.x >= kCells || entry.cell.y >= kCells;
      ASSERT_EQ(entry.leaf == kNone, is_outside);
      if (is_outside) {
        along += entry.is_corner ? 0 : s.side;
        continue;
      }
      const Square o = square_of(keys, entry.leaf);
      const std::int64_t touch_x = std::min(s.x + s.side, o.x + o.side) - std::max(s.x, o.x);
      const std::int64_t touch_y = std::min(s.y + s.side, o.y + o.side) - std::max(s.y, o.y);
      ASSERT_EQ(std::min(touch_x, touch_y), 0);
      if (!entry.is_corner) along += std::max(touch_x, touch_y);
      touching[{l, entry.leaf}] = 1;
      ASSERT_EQ(leaf_by_key(keys, entry.cell), entry.leaf);
    }
    EXPECT_EQ(along, 4 * s.side);
    EXPECT_EQ(corners, 4);
  }
  for (const auto& [pair, one] : touching) EXPECT_TRUE(touching.contains({pair.second, pair.first}));
}

}  // namespace
}  // namespace curvecast
