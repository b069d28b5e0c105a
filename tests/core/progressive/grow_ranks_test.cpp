#include "core/progressive/grow_ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <set>

#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr std::size_t kNew = kChunkStrata / 4 * 3;  // points of a chunk that continues another

void expect_same(const RankChunk& a, const RankChunk& b) {
  EXPECT_TRUE(a.id == b.id && a.x == b.x && a.y == b.y && a.z == b.z && a.rank == b.rank && a.vertex == b.vertex &&
              a.curve_position == b.curve_position)
      << a.id.level << ' ' << a.id.index;
}

const RankChunk* find(const RankTree& tree, const ChunkId& id) {
  for (const auto& chunk : tree.chunks()) {
    if (chunk->id == id) return chunk.get();
  }
  return nullptr;
}

TEST(RankGrower, HasEveryRankOnce) {
  const auto tree = ball_tree(8);
  EXPECT_EQ(tree->points(), 65'536u);
  ASSERT_EQ(tree->chunks().size(), 1u + 4 + 16 + 64);
  std::vector<int> times(65'536, 0);
  for (const auto& chunk : tree->chunks()) {
    EXPECT_EQ(chunk->size(), chunk->id.level == kChunkLevels ? kChunkStrata : kNew);
    for (std::size_t i = 0; i < chunk->size(); ++i) {
      // Layer by layer, each along the curve.
      if (i % kLayerStrata > 0) {
        EXPECT_LT(chunk->curve_position[i - 1], chunk->curve_position[i]);
      }
      EXPECT_EQ(chunk->rank[i] / chunk->id.layer_ranks(), chunk->id.first_rank(i / kLayerStrata) / chunk->id.layer_ranks());
      ++times[chunk->rank[i]];
      EXPECT_GE(chunk->rank[i], chunk->id.first_rank());
      if (chunk->id.level > kChunkLevels) {
        EXPECT_EQ(chunk->curve_position[i] >> (64 - 2 * (chunk->id.level - kChunkLevels)), chunk->id.index);
      }
    }
  }
  EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int t) { return t == 1; }));
}

TEST(RankGrower, WhatGrowsIsWhatTheWholeWouldBe) {
  const auto whole = ball_tree(9);
  const auto grower = ball_grower(6);
  const std::vector<std::vector<ChunkId>> asked = {
      {{7, 3}, {7, 0}}, {{8, 2}, {8, 14}, {8, 15}, {8, 1}}, {{9, 63}, {9, 9}, {9, 10}}};
  std::size_t chunks = 1;
  for (const auto& lacking : asked) {
    ASSERT_TRUE(grower->grow(lacking, 1'000'000).ok());
    chunks = grower->tree()->chunks().size();
    for (const ChunkId& id : lacking) EXPECT_NE(find(*grower->tree(), id), nullptr) << id.level << ' ' << id.index;
  }
  EXPECT_GE(chunks, 1u + 2 + 4 + 3);
  for (const auto& chunk : grower->tree()->chunks()) expect_same(*chunk, *find(*whole, chunk->id));
}

TEST(RankGrower, MuchIsMadeAsAWhole) {
  const auto whole = ball_tree(8);
  const auto grower = ball_grower(6);
  std::vector<ChunkId> lacking;
  for (std::uint64_t i = 0; i < 10; ++i) lacking.push_back({7, i});
  ASSERT_TRUE(grower->grow(lacking, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 16'384u);
  std::vector<ChunkId> next;
  for (std::uint64_t i = 0; i < 30; ++i) next.push_back({8, i});
  ASSERT_TRUE(grower->grow(next, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 65'536u);
  for (const auto& chunk : grower->tree()->chunks()) expect_same(*chunk, *find(*whole, chunk->id));
}

TEST(RankGrower, TreesOfBeforeStay) {
  const auto grower = ball_grower(6);
  const auto before = grower->tree();
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{7, 2}}, 1'000'000).ok());
  EXPECT_EQ(before->points(), 4096u);
  EXPECT_EQ(grower->tree()->points(), 4096u + kNew);
  // Again, and what nothing leads to: nothing new.
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{7, 2}, {8, 0}}, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 4096u + kNew);
}

TEST(RankGrower, GoesAsDeepAsThereAreRanks) {
  const auto grower = ball_grower(6);
  const auto index_at = [](int level) { return (std::uint64_t{1} << 2 * (level - kChunkLevels)) * 5 / 8; };
  for (int level = 7; level <= kMaxRankLevel; ++level) {
    ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{level, index_at(level)}}, 1'000'000).ok()) << level;
    const RankChunk* const chunk = find(*grower->tree(), {level, index_at(level)});
    ASSERT_NE(chunk, nullptr) << level;
    EXPECT_EQ(std::set<std::uint64_t>(chunk->curve_position.begin(), chunk->curve_position.end()).size(), chunk->size()) << level;
    std::set<std::vector<float>> places;
    for (std::size_t i = 0; i < chunk->size(); ++i) places.insert({chunk->x[i], chunk->y[i], chunk->z[i]});
    EXPECT_EQ(places.size(), chunk->size()) << level << ": each point has a place of its own";
  }
  const std::size_t points = grower->tree()->points();
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{kMaxRankLevel + 1, index_at(kMaxRankLevel + 1)}}, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), points);
}

TEST(RankGrower, WhatWasLetGoOfComesBackTheSame) {
  const auto grower = ball_grower(6), other = ball_grower(6);
  std::vector<RankTree::Chunk> first;
  for (int level = 7; level <= 12; ++level) {
    ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{level, 0}}, 1'000'000).ok());
    first.push_back(grower->tree()->chunks()[grower->tree()->find({level, 0})]);
  }
  // Elsewhere, with room for a few chunks only: those are not looked at any more.
  for (int level = 7; level <= 12; ++level) {
    const std::uint64_t last = (std::uint64_t{1} << 2 * (level - kChunkLevels)) - 1;
    ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{level, last}}, 4096).ok());
  }
  EXPECT_EQ(grower->tree()->find({12, 0}), RankTree::kNone);
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{6, 0}}, 1'000'000).ok());
  for (int level = 7; level <= 12; ++level) {
    ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{level, 0}}, 1'000'000).ok());
    ASSERT_NE(grower->tree()->find({level, 0}), RankTree::kNone);
    expect_same(*grower->tree()->chunks()[grower->tree()->find({level, 0})], *first[static_cast<std::size_t>(level - 7)]);
  }
}

TEST(RankGrower, GoesOnFromATreeOfBefore) {
  const auto grower = ball_grower(6);
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{7, 3}, {8, 14}, {9, 57}}, 1'000'000).ok());
  const auto again = RankGrower::restore(ball_surface(), {.level = 6}, grower->tree());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ((*again)->tree(), grower->tree());
  const std::vector<ChunkId> more = {{7, 0}, {8, 13}, {9, 58}, {10, 230}};
  for (RankGrower* const one : {grower.get(), again->get()}) ASSERT_TRUE(one->grow(more, 1'000'000).ok());
  ASSERT_EQ((*again)->tree()->chunks().size(), grower->tree()->chunks().size());
  EXPECT_EQ((*again)->tree()->chunks().size(), 5u + 3 + 4);
  for (std::size_t c = 0; c < grower->tree()->chunks().size(); ++c) {
    expect_same(*(*again)->tree()->chunks()[c], *grower->tree()->chunks()[c]);
  }
}

TEST(RankGrower, MakesAnewWhatTheSurfaceDoesNotHave) {
  const auto tree = ball_tree(6);
  std::vector<RankTree::Chunk> chunks(tree->chunks().begin(), tree->chunks().end());
  auto moved = std::make_shared<RankChunk>(*chunks[2]);
  moved->x[5] += 0.001f;
  chunks[2] = moved;
  const auto again = RankGrower::restore(ball_surface(), {.level = 6}, std::make_shared<const RankTree>(chunks));
  ASSERT_TRUE(again.ok()) << again.status();
  for (std::size_t c = 0; c < chunks.size(); ++c) expect_same(*(*again)->tree()->chunks()[c], *tree->chunks()[c]);
}

TEST(RankGrower, RefusesWhatCannotBe) {
  for (const int level : {kChunkLevels - 1, kMaxLevelAtOnce + 1}) {
    EXPECT_EQ(RankGrower::make(ball_surface(), {.level = level}).status().code(), absl::StatusCode::kInvalidArgument);
  }
  const auto grower = ball_grower(6);
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_EQ(grower->grow(std::vector<ChunkId>{{7, 0}}, 1'000'000, context).code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(grower->tree()->points(), 4096u);
}

}  // namespace
}  // namespace curvecast
