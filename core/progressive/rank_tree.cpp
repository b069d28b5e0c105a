#include "core/progressive/rank_tree.h"

#include <algorithm>
#include <utility>

namespace curvecast {

RankTree::RankTree(std::vector<Chunk> chunks, std::uint64_t growth) : growth_(growth) {
  std::stable_sort(chunks.begin(), chunks.end(), [](const Chunk& a, const Chunk& b) { return a->id < b->id; });
  for (Chunk& chunk : chunks) {
    const ChunkId& id = chunk->id;
    if (!chunks_.empty() && chunks_.back()->id == id) continue;
    if (id.level > kChunkLevels) {
      const std::uint32_t parent = find({id.level - 1, id.index / 4});
      if (parent == kNone) continue;
      children_[parent][id.index % 4] = static_cast<std::uint32_t>(chunks_.size());
    }
    points_ += chunk->size();
    chunks_.push_back(std::move(chunk));
    children_.push_back({kNone, kNone, kNone, kNone});
  }
}

RankTree RankTree::grown(std::span<const Chunk> more, std::size_t max_points) const {
  std::vector<Chunk> all = chunks_;
  for (const Chunk& chunk : more) {
    chunk->used.set(growth_ + 1);
    all.push_back(chunk);
  }
  std::size_t points = points_;
  for (const Chunk& chunk : more) points += chunk->size();
  if (points > max_points) {
    // Whoever looks at a chunk looks at its parent: no chunk was used later than its parent, so none loses it.
    std::vector<std::pair<std::uint64_t, std::size_t>> unused;  // when used last, and which
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      if (chunks_[c]->id.level > kChunkLevels && chunks_[c]->used.get() < growth_) unused.emplace_back(chunks_[c]->used.get(), c);
    }
    std::sort(unused.begin(), unused.end(),
              [](const auto& a, const auto& b) { return a.first < b.first || (a.first == b.first && a.second > b.second); });
    for (const auto& [used, c] : unused) {
      if (points <= max_points) break;
      points -= all[c]->size();
      all[c] = nullptr;
    }
    std::erase(all, nullptr);
  }
  return RankTree(std::move(all), growth_ + 1);
}

std::uint32_t RankTree::find(const ChunkId& id) const {
  const auto at =
      std::lower_bound(chunks_.begin(), chunks_.end(), id, [](const Chunk& c, const ChunkId& i) { return c->id < i; });
  return at != chunks_.end() && (*at)->id == id ? static_cast<std::uint32_t>(at - chunks_.begin()) : kNone;
}

int RankTree::level_at(std::size_t c, std::uint64_t curve_position) const {
  for (;;) {
    const int level = chunks_[c]->id.level;
    const std::uint32_t next = children_[c][curve_position >> (64 - 2 * (level + 1 - kChunkLevels)) & 3];
    if (next == kNone) return level;
    c = next;
  }
}

std::size_t RankTree::byte_size() const {
  constexpr std::size_t kPointBytes =
      3 * sizeof(float) + 3 * sizeof(Snorm16) + sizeof(std::uint64_t) + 3 * sizeof(std::uint32_t) + 3 * sizeof(Unorm16);
  constexpr std::size_t kChunkBytes = sizeof(RankChunk);
  const RankChunk& first = *chunks_.front();  // which lies everywhere
  const std::size_t more_bytes = (first.colour.empty() ? 0 : sizeof(Rgba8)) + (first.beside.empty() ? 0 : sizeof(Direction8));
  return points_ * (kPointBytes + more_bytes) + chunks_.size() * (kChunkBytes + sizeof(Chunk) + sizeof(children_[0]));
}

}  // namespace curvecast
