// The chunks of ranked points that there are so far: everywhere down to some level, deeper where a view has come close.
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

/// Chunks and which continues which. Immutable: a tree that has grown or lost chunks is another tree, which shares the chunks of
/// the first.
class RankTree {
 public:
  using Chunk = std::shared_ptr<const RankChunk>;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Leaves out chunks whose id another chunk has already, and chunks whose parent is not there. Precondition: the first chunk is
  /// there. `growth`: how often the tree has grown.
  explicit RankTree(std::vector<Chunk> chunks, std::uint64_t growth = 0);
  /// Returns the tree with more chunks, but where it has more than `max_points` then, without those that were not used for
  /// longest, the deepest first. Chunks that were used since it last grew stay.
  RankTree grown(std::span<const Chunk> more, std::size_t max_points) const;

  std::uint64_t growth() const { return growth_; }
  /// Returns all chunks, by level, then along the curve: a chunk comes after its parent.
  std::span<const Chunk> chunks() const { return chunks_; }
  /// Returns the index of a child of chunk c in chunks(), quarter 0 to 3; kNone where the child is not there yet.
  std::uint32_t child(std::size_t c, std::size_t quarter) const { return children_[c][quarter]; }
  /// Returns the index of a chunk in chunks(); kNone where it is not there.
  std::uint32_t find(const ChunkId& id) const;
  /// Returns the level down to which all points are there around a point of chunk c with this curve position.
  int level_at(std::size_t c, std::uint64_t curve_position) const;
  std::size_t points() const { return points_; }
  /// Returns about how many bytes the tree and its chunks take.
  std::size_t byte_size() const;

 private:
  std::vector<Chunk> chunks_;
  std::vector<std::array<std::uint32_t, 4>> children_;
  std::uint64_t growth_;
  std::size_t points_ = 0;
};

}  // namespace curvecast
