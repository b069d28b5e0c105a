// The progressive sampler's candidates as a view reads them: those that a level adds in one part of the surface, in columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/quantised.h"
#include "core/curve/curve_blocks.h"
#include "core/progressive/rank_block.h"
#include "core/progressive/stratum_bounds.h"

namespace curvecast {

/// The first chunk has the points of the 4^kChunkLevels lowest ranks.
inline constexpr int kChunkLevels = 6;
inline constexpr std::size_t kChunkStrata = std::size_t{1} << 2 * kChunkLevels;
/// A chunk's points in curve order are so many runs of equal length.
inline constexpr std::size_t kChunkRuns = 16;

/// Which chunk: that of level kChunkLevels (index 0) is the first; those of higher levels hold the ranks [4^(level - 1), 4^level)
/// of the stratum `index` of level - kChunkLevels. Four of the next level continue it, 4 index to 4 index + 3.
struct ChunkId {
  int level = kChunkLevels;
  std::uint64_t index = 0;

  /// No point in it has a lower rank.
  std::uint64_t first_rank() const { return level == kChunkLevels ? 0 : std::uint64_t{1} << 2 * (level - 1); }
  ChunkId child(std::uint64_t quarter) const { return {level + 1, 4 * index + quarter}; }
  auto operator<=>(const ChunkId&) const = default;
};

struct RankChunk {
  ChunkId id;
  std::vector<float> x, y, z;       // relative to the curve's origin
  std::vector<Snorm16> nx, ny, nz;  // unit
  std::vector<std::uint32_t> rank;
  std::vector<std::uint32_t> vertex;  // of the curve
  std::vector<std::uint32_t> place;   // along the curve: the highest 32 bits of the area coordinate; no two points share it
  CurveBlocks bounds;                 // of the strata in which the runs lie, deeper points included; without area
  std::array<std::uint32_t, kChunkRuns> first_vertex{}, last_vertex{};  // of the runs' strata

  std::size_t size() const { return x.size(); }
  std::size_t run_size() const { return size() / kChunkRuns; }
};

/// Of all points of level id.level in the chunk's stratum, kChunkStrata of them, the chunk's own.
RankChunk make_chunk(const ChunkId& id, std::span<const RankedPoint> points, const StratumBounds& bounds);

}  // namespace curvecast
