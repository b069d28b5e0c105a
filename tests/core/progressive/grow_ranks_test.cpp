#include "core/progressive/grow_ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

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
  ASSERT_EQ(tree->chunks().size(), 1u + 4 + 16);
  std::vector<int> times(65'536, 0);
  for (const auto& chunk : tree->chunks()) {
    EXPECT_EQ(chunk->size(), chunk->id.level == kChunkLevels ? 4096u : 3072u);
    EXPECT_TRUE(std::is_sorted(chunk->curve_position.begin(), chunk->curve_position.end()));
    for (std::size_t i = 0; i < chunk->size(); ++i) {
      ++times[chunk->rank[i]];
      EXPECT_GE(chunk->rank[i], chunk->id.first_rank());
      EXPECT_EQ(std::uint64_t{chunk->curve_position[i]} >> (32 - 2 * (chunk->id.level - kChunkLevels)), chunk->id.index);
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
  const std::vector<ChunkId> lacking = {{7, 0}, {7, 1}, {7, 3}};
  ASSERT_TRUE(grower->grow(lacking, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 16'384u);
  std::vector<ChunkId> next;
  for (std::uint64_t i = 0; i < 10; ++i) next.push_back({8, i});
  ASSERT_TRUE(grower->grow(next, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 65'536u);
  for (const auto& chunk : grower->tree()->chunks()) expect_same(*chunk, *find(*whole, chunk->id));
}

TEST(RankGrower, TreesOfBeforeStay) {
  const auto grower = ball_grower(6);
  const auto before = grower->tree();
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{7, 2}}, 1'000'000).ok());
  EXPECT_EQ(before->points(), 4096u);
  EXPECT_EQ(grower->tree()->points(), 4096u + 3072);
  // Again, and what nothing leads to: nothing new.
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{7, 2}, {8, 0}}, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), 4096u + 3072);
}

TEST(RankGrower, GoesAsDeepAsThereAreRanks) {
  const auto grower = ball_grower(6);
  for (int level = 7; level <= grower->tree()->deepest(); ++level) {
    const ChunkId id{level, (std::uint64_t{1} << 2 * (level - kChunkLevels)) * 5 / 8};
    ASSERT_TRUE(grower->grow(std::vector<ChunkId>{id}, 1'000'000).ok()) << level;
    const RankChunk* const chunk = find(*grower->tree(), id);
    ASSERT_NE(chunk, nullptr) << level;
    EXPECT_EQ(std::set<std::uint32_t>(chunk->curve_position.begin(), chunk->curve_position.end()).size(), chunk->size()) << level;
  }
  // Eight points on a curve vertex, and no more.
  const auto size = static_cast<double>(ball_curve()->size());
  EXPECT_LE(std::ldexp(1.0, 2 * grower->tree()->deepest()), 8 * size);
  EXPECT_GT(std::ldexp(1.0, 2 * grower->tree()->deepest() + 2), 8 * size);
  const std::size_t points = grower->tree()->points();
  ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{grower->tree()->deepest() + 1, 0}}, 1'000'000).ok());
  EXPECT_EQ(grower->tree()->points(), points);
}

TEST(RankGrower, RefusesWhatCannotBe) {
  for (const int level : {kChunkLevels - 1, kMaxLevelAtOnce + 1}) {
    EXPECT_EQ(RankGrower::make(ball_curve(), {.level = level}).status().code(), absl::StatusCode::kInvalidArgument);
  }
  const auto grower = ball_grower(6);
  EXPECT_EQ(grower->grow(std::vector<ChunkId>{{7, 0}}, 7000).code(), absl::StatusCode::kResourceExhausted);
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_EQ(grower->grow(std::vector<ChunkId>{{7, 0}}, 1'000'000, context).code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(grower->tree()->points(), 4096u);
}

}  // namespace
}  // namespace curvecast
