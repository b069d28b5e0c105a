// The chunks of ranked candidates that there are so far: everywhere down to some level, deeper where a view has come close.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/progressive/rank_chunk.h"

namespace curvecast {

/// Immutable: a tree that has grown is another one that shares the chunks of the first.
class RankTree {
 public:
  using Chunk = std::shared_ptr<const RankChunk>;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Chunks that others already stand for, and such as nothing leads to, are left out. Precondition: the first chunk is there.
  /// `deepest`: the level beyond which there will be none.
  RankTree(std::vector<Chunk> chunks, int deepest);
  RankTree with(std::span<const Chunk> more) const;

  /// By level, then along the curve: chunks come after those that they continue.
  std::span<const Chunk> chunks() const { return chunks_; }
  /// Which of chunks() continues chunk c in a quarter, 0 to 3; kNone where there is none yet.
  std::uint32_t child(std::size_t c, std::size_t quarter) const { return children_[c][quarter]; }
  /// Down to which level there are all points around one of chunk c, at a place along the curve (RankChunk::place).
  int level_at(std::size_t c, std::uint32_t place) const;
  int deepest() const { return deepest_; }
  std::size_t points() const { return points_; }
  std::size_t byte_size() const;

 private:
  std::vector<Chunk> chunks_;
  std::vector<std::array<std::uint32_t, 4>> children_;
  int deepest_;
  std::size_t points_ = 0;
};

}  // namespace curvecast
