#include "core/progressive/rank_tree.h"

#include <algorithm>

namespace curvecast {

RankTree::RankTree(std::vector<Chunk> chunks, int deepest) : deepest_(deepest) {
  std::stable_sort(chunks.begin(), chunks.end(), [](const Chunk& a, const Chunk& b) { return a->id < b->id; });
  for (Chunk& chunk : chunks) {
    const ChunkId& id = chunk->id;
    if (!chunks_.empty() && chunks_.back()->id == id) continue;
    if (id.level > kChunkLevels) {
      const ChunkId parent{id.level - 1, id.index / 4};
      const auto at =
          std::lower_bound(chunks_.begin(), chunks_.end(), parent, [](const Chunk& c, const ChunkId& i) { return c->id < i; });
      if (at == chunks_.end() || (*at)->id != parent) continue;
      children_[static_cast<std::size_t>(at - chunks_.begin())][id.index % 4] = static_cast<std::uint32_t>(chunks_.size());
    }
    points_ += chunk->size();
    chunks_.push_back(std::move(chunk));
    children_.push_back({kNone, kNone, kNone, kNone});
  }
}

RankTree RankTree::with(std::span<const Chunk> more) const {
  std::vector<Chunk> all = chunks_;
  all.insert(all.end(), more.begin(), more.end());
  return {std::move(all), deepest_};
}

int RankTree::level_at(std::size_t c, std::uint32_t curve_position) const {
  for (;;) {
    const int level = chunks_[c]->id.level;
    const std::uint32_t next = children_[c][curve_position >> (32 - 2 * (level + 1 - kChunkLevels)) & 3];
    if (next == kNone) return level;
    c = next;
  }
}

std::size_t RankTree::byte_size() const {
  constexpr std::size_t kPointBytes = 3 * sizeof(float) + 3 * sizeof(Snorm16) + 3 * sizeof(std::uint32_t);
  constexpr std::size_t kChunkBytes = sizeof(RankChunk) + kChunkRuns * 8 * sizeof(float);
  return points_ * kPointBytes + chunks_.size() * (kChunkBytes + sizeof(Chunk) + sizeof(children_[0]));
}

}  // namespace curvecast
