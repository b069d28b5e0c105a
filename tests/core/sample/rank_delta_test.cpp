#include "core/sample/rank_delta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/sample/random.h"
#include "tests/core/sample/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(RankDelta, WhoAppliesDeltasHasTheSelection) {
  const auto grower = ball_grower(6);
  RankSelector selector;
  RankSelection earlier, later;
  earlier.tree = grower->tree();
  std::set<std::uint32_t> held;
  RankDelta delta;
  for (std::uint64_t frame = 0; frame < 60; ++frame) {
    const double angle = 20 * random_unit(1, frame);
    const Vec3d eye = Vec3d(std::sin(angle), 0.4, std::cos(angle)) * (1.2 + 4 * random_unit(2, frame));
    const auto n = static_cast<std::uint64_t>(1 + 6000 * random_unit(3, frame));
    selector.select(grower->tree(), nullptr, ViewFactor(*ball_curve(), view_from(eye)), n, later);
    if (frame % 3 == 0) {
      ASSERT_TRUE(grower->grow(later.lacking, 4'000'000).ok());
    }
    compare(earlier, later, delta);
    for (const std::uint32_t rank : delta.removed) EXPECT_EQ(held.erase(rank), 1u);
    for (const RankRef& ref : delta.added) {
      EXPECT_TRUE(held.insert(later.tree->chunks()[ref.chunk]->rank[ref.point]).second);
    }
    EXPECT_TRUE(std::ranges::equal(held, ranks_of(later)));
    std::swap(earlier, later);
  }
  compare(earlier, earlier, delta);
  EXPECT_TRUE(delta.added.empty() && delta.removed.empty());
}

TEST(RankDelta, SmallMovesChangeFewPoints) {
  const auto tree = ball_tree(8);
  RankSelector selector;
  RankSelection earlier, later;
  const auto look = [&](double degrees, RankSelection& out) {
    const double angle = degrees * M_PI / 180;
    const Density terms = view_from(Vec3d(3 * std::sin(angle), 1, 3 * std::cos(angle)));
    selector.select(tree, nullptr, ViewFactor(*ball_curve(), terms), 8000, out);
  };
  look(0, earlier);
  look(1, later);
  RankDelta delta;
  compare(earlier, later, delta);
  EXPECT_EQ(delta.added.size(), delta.removed.size());
  EXPECT_GT(delta.added.size(), 0u);
  EXPECT_LT(delta.added.size(), 8000u * 5 / 100);
}

}  // namespace
}  // namespace curvecast
