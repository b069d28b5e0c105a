#include "core/progressive/rank_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
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

constexpr auto kAll = std::numeric_limits<std::size_t>::max();
const std::vector<ChunkId> kIds = {{5, 0}, {6, 0}, {6, 3}, {7, 1}, {7, 12}, {7, 15}, {8, 60}};

TEST(RankTree, OrdersChunksByLevelThenAlongTheCurve) {
  std::vector<ChunkId> ids = kIds;
  std::reverse(ids.begin(), ids.end());
  EXPECT_EQ(ids_of(RankTree(chunks_of(ids))), kIds);
}

TEST(RankTree, KnowsTheChildrenOfEveryChunk) {
  const RankTree tree(chunks_of(kIds));
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
  const RankTree tree(chunks_of(kIds));
  const auto first = tree.chunks();
  const RankTree same = tree.grown(chunks_of({{7, 1}, {7, 4}, {8, 48 + 7}, {9, 0}}), kAll);
  EXPECT_EQ(ids_of(same), kIds);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), same.chunks().begin())) << "the chunks that were there first stay";
  EXPECT_EQ(same.points(), tree.points());
}

TEST(RankTree, GrowsTheSameInAnyOrderOfParentsAndChildren) {
  RankTree tree(chunks_of({{5, 0}}));
  tree = tree.grown(chunks_of({{7, 15}, {6, 3}, {6, 0}}), kAll);
  tree = tree.grown(chunks_of({{8, 60}, {7, 12}, {7, 1}, {7, 15}}), kAll);
  EXPECT_EQ(ids_of(tree), kIds);
  EXPECT_EQ(tree.points(), kChunkStrata + 6 * (kChunkStrata / 4 * 3));
}

TEST(RankTree, LetsGoOfWhatNobodyHasLookedAtForLongest) {
  constexpr std::size_t kChunk = kChunkStrata / 4 * 3;
  RankTree tree(chunks_of({{5, 0}}));
  tree = tree.grown(chunks_of({{6, 0}, {6, 1}}), kAll);
  tree = tree.grown(chunks_of({{7, 0}, {7, 5}}), kAll);
  // A view looks at one chunk and at those above.
  for (const ChunkId& id : {ChunkId{5, 0}, ChunkId{6, 1}, ChunkId{7, 5}}) tree.chunks()[tree.find(id)]->used.set(tree.growth());
  const std::vector<RankTree::Chunk> more = chunks_of({{7, 4}});
  const RankTree smaller = tree.grown(more, kChunkStrata + 4 * kChunk);
  const std::vector<ChunkId> left = {{5, 0}, {6, 1}, {7, 4}, {7, 5}};
  EXPECT_EQ(ids_of(smaller), left);
  EXPECT_LE(smaller.points(), kChunkStrata + 4 * kChunk);
  // What is in use stays, however little room there is.
  EXPECT_EQ(ids_of(tree.grown(more, 0)), left);
}

TEST(RankTree, LevelAtIsThatOfTheDeepestChunkThere) {
  const RankTree tree(chunks_of(kIds));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto position = static_cast<std::uint64_t>(random_unit(1, i) * 0x1p64);
    int deepest = 0;
    for (const ChunkId& id : kIds) {
      if (id.level == kChunkLevels || position >> (64 - 2 * (id.level - kChunkLevels)) == id.index)
        deepest = std::max(deepest, id.level);
    }
    EXPECT_EQ(tree.level_at(0, position), deepest);
  }
}

}  // namespace
}  // namespace curvecast
