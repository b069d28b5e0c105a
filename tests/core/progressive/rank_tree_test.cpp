#include "core/progressive/rank_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// A chunk of which only the id and the number of points matter.
RankTree::Chunk chunk_of(const ChunkId& id) {
  auto chunk = std::make_shared<RankChunk>();
  chunk->id = id;
  chunk->x.resize(id.level == kChunkLevels ? kChunkStrata : kChunkStrata / 4 * 3);
  return chunk;
}

std::vector<RankTree::Chunk> chunks_of(const std::vector<ChunkId>& ids) {
  std::vector<RankTree::Chunk> chunks;
  for (const ChunkId& id : ids) chunks.push_back(chunk_of(id));
  return chunks;
}

std::vector<ChunkId> ids_of(const RankTree& tree) {
  std::vector<ChunkId> ids;
  for (const RankTree::Chunk& chunk : tree.chunks()) ids.push_back(chunk->id);
  return ids;
}

const std::vector<ChunkId> kIds = {{6, 0}, {7, 0}, {7, 3}, {8, 1}, {8, 12}, {8, 15}, {9, 60}};

TEST(RankTree, OrdersChunksByLevelThenAlongTheCurve) {
  std::vector<ChunkId> ids = kIds;
  std::reverse(ids.begin(), ids.end());
  EXPECT_EQ(ids_of(RankTree(chunks_of(ids), 10)), kIds);
}

TEST(RankTree, KnowsTheChildrenOfEveryChunk) {
  const RankTree tree(chunks_of(kIds), 10);
  std::size_t children = 0;
  for (std::size_t c = 0; c < kIds.size(); ++c) {
    for (std::size_t q = 0; q < 4; ++q) {
      const auto there = std::find(kIds.begin(), kIds.end(), kIds[c].child(q));
      if (there == kIds.end()) {
        EXPECT_EQ(tree.child(c, q), RankTree::kNone);
      } else {
        EXPECT_EQ(tree.child(c, q), there - kIds.begin());
        ++children;
      }
    }
  }
  EXPECT_EQ(children, kIds.size() - 1) << "all but the first are children";
}

TEST(RankTree, LeavesOutDoublesAndChunksWithoutAParent) {
  const RankTree tree(chunks_of(kIds), 10);
  const auto first = tree.chunks();
  const RankTree same = tree.with(chunks_of({{8, 1}, {8, 4}, {9, 48 + 7}, {10, 0}}));
  EXPECT_EQ(ids_of(same), kIds);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), same.chunks().begin())) << "the chunks that were there first stay";
  EXPECT_EQ(same.points(), tree.points());
  EXPECT_EQ(same.deepest(), 10);
}

TEST(RankTree, GrowsTheSameInAnyOrderOfParentsAndChildren) {
  RankTree tree(chunks_of({{6, 0}}), 10);
  tree = tree.with(chunks_of({{8, 15}, {7, 3}, {7, 0}}));
  tree = tree.with(chunks_of({{9, 60}, {8, 12}, {8, 1}, {8, 15}}));
  EXPECT_EQ(ids_of(tree), kIds);
  EXPECT_EQ(tree.points(), kChunkStrata + 6 * (kChunkStrata / 4 * 3));
}

TEST(RankTree, LevelAtIsThatOfTheDeepestChunkThere) {
  const RankTree tree(chunks_of(kIds), 10);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto position = static_cast<std::uint32_t>(random_unit(1, i) * 0x1p32);
    int deepest = 0;
    for (const ChunkId& id : kIds) {
      if (std::uint64_t{position} >> (32 - 2 * (id.level - kChunkLevels)) == id.index) deepest = std::max(deepest, id.level);
    }
    EXPECT_EQ(tree.level_at(0, position), deepest);
  }
}

}  // namespace
}  // namespace curvecast
