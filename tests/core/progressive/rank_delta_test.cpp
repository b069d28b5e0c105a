#include "core/progressive/rank_delta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"
#include "core/progressive/sample_ranked.h"
#include "core/sample/radius_ladder.h"
#include "core/sample/splat_radius.h"
#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(RankDelta, WhoAppliesDeltasHasTheSelection) {
  const auto grower = ball_grower(6);
  RankSelector selector;
  RankSelection earlier, later;
  std::set<std::uint32_t> held;
  RankDelta delta;
  for (std::uint64_t frame = 0; frame < 60; ++frame) {
    const double angle = 20 * random_unit(1, frame);
    const Vec3d eye = Vec3d(std::sin(angle), 0.4, std::cos(angle)) * (1.2 + 4 * random_unit(2, frame));
    const auto n = static_cast<std::uint64_t>(1 + 6000 * random_unit(3, frame));
    selector.select(grower->tree(), nullptr, ViewFactor(*ball_curve(), view_from(eye)), n, later);
    if (frame % 3 == 0) {
      ASSERT_TRUE(grower->grow(later.most_lacking(), 4'000'000).ok());
    }
    compare(earlier, {}, later, delta);
    for (const RankRef& ref : delta.removed) EXPECT_EQ(held.erase(earlier.chunk(ref).rank[ref.point]), 1u);
    for (const RankRef& ref : delta.added) {
      EXPECT_TRUE(held.insert(later.chunk(ref).rank[ref.point]).second);
    }
    EXPECT_TRUE(delta.resized.empty()) << "nobody knows the discs";
    EXPECT_TRUE(std::ranges::equal(held, ranks_of(later)));
    std::swap(earlier, later);
  }
  compare(earlier, {}, earlier, delta);
  EXPECT_TRUE(delta.added.empty() && delta.removed.empty());
}

/// A point of the list of a client that is told of changes.
struct Held {
  std::uint32_t rank;
  int rung;
  bool operator==(const Held&) const = default;
};

std::vector<Held> list_of(const RankedWorkspace& workspace) {
  std::vector<Held> list;
  const RadiusLadder ladder(SplatRadius::largest(*ball_curve()));
  for (std::size_t i = 0; i < workspace.points.size(); ++i) {
    list.push_back({workspace.points.ranks[i], ladder.rung(workspace.points.radii[i])});
  }
  return list;
}

TEST(RankDelta, WhoAppliesListDeltasHasTheList) {
  const auto grower = ball_grower(6);
  RankedWorkspace workspace;
  RankSelection held;
  std::vector<Held> list;
  for (std::uint64_t frame = 0; frame < 60; ++frame) {
    const double angle = 3 * random_unit(4, frame);
    const Vec3d eye = Vec3d(std::sin(angle), 0.4, std::cos(angle)) * (1.2 + random_unit(5, frame));
    const auto n = static_cast<std::uint64_t>(4000 + 2000 * random_unit(6, frame));
    ASSERT_TRUE(select_ranked(*ball_curve(), grower->tree(), nullptr, view_from(eye), n, workspace).ok());
    const RankSelection& selection = workspace.selection;
    list_ranked(*ball_curve(), workspace);
    const std::vector<Held> all = list_of(workspace);
    if (frame > 0) {
      RankDelta delta;
      ListDelta indices;
      compare(held, held.rungs, selection, delta);
      locate(held, selection, delta, indices);
      PointSet added;
      gather_ranked(*ball_curve(), selection, delta.added, added);
      ASSERT_EQ(indices.added.size(), added.size());
      for (std::size_t i = indices.removed.size(); i-- > 0;) list.erase(list.begin() + indices.removed[i]);
      for (std::size_t i = 0; i < added.size(); ++i) {
        list.insert(list.begin() + indices.added[i], Held{added.ranks[i], delta.added[i].rung});
      }
      for (std::size_t i = 0; i < indices.resized.size(); ++i) {
        ASSERT_EQ(list[indices.resized[i]].rung, delta.resized[i].from);
        list[indices.resized[i]].rung = delta.resized[i].point.rung;
      }
      ASSERT_EQ(list, all) << frame;
    }
    list = all;
    held = selection;
    if (frame % 3 == 0) {
      ASSERT_TRUE(grower->grow(selection.most_lacking(), 4'000'000).ok());
    }
  }
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
  compare(earlier, {}, later, delta);
  EXPECT_EQ(delta.added.size(), delta.removed.size());
  EXPECT_GT(delta.added.size(), 0u);
  EXPECT_LT(delta.added.size(), 8000u * 5 / 100);
}

}  // namespace
}  // namespace curvecast
