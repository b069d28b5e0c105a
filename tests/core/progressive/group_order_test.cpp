#include "core/progressive/block_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using Blocks = std::vector<std::uint64_t>;

TEST(BlockOrder, IsTotal) {
  constexpr int kLevel = 6;
  Blocks blocks(BlockOrder::blocks(kLevel));
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = i;
  std::sort(blocks.begin(), blocks.end(), [](std::uint64_t a, std::uint64_t b) { return BlockOrder::precedes(kLevel, a, b); });
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    EXPECT_TRUE(BlockOrder::precedes(kLevel, blocks[i - 1], blocks[i]));
    EXPECT_FALSE(BlockOrder::precedes(kLevel, blocks[i], blocks[i - 1]));
  }
}

/// All near blocks of a level, from those of the levels before.
std::vector<Blocks> near_blocks(const BlockOrder& order, int level) {
  std::vector<Blocks> near(BlockOrder::blocks(level));
  const std::vector<Blocks> parents = near.size() > 1 ? near_blocks(order, level - 1) : std::vector<Blocks>{{0}};
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = order.near({level, i}, parents[i / 4]);
  return near;
}

TEST(BlockOrder, FindsAllNearBlocks) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const BlockOrder order(strata, 7);
  for (const int level : {2, 3, 4, 6}) {
    const std::vector<Blocks> near = near_blocks(order, level);
    const float reach = rank_reach(strata.total_area(), level);
    for (std::uint64_t i = 0; i < near.size(); ++i) {
      Blocks expected;
      for (std::uint64_t j = 0; j < near.size(); ++j) {
        if (order.box({level, i}).exteriorDistance(order.box({level, j})) <= reach) expected.push_back(j);
      }
      EXPECT_EQ(near[i], expected);
    }
  }
}

TEST(BlockOrder, DoesNotDependOnWhatWasMadeReady) {
  const auto curve = flat_curve(7);
  const CurveStrata strata(*curve);
  const BlockOrder ready(strata, 7), other(strata, 1);
  EXPECT_EQ(near_blocks(ready, 6), near_blocks(other, 6));
}

}  // namespace
}  // namespace curvecast
