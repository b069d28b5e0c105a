// Ranked points as a view reads them: those that one level adds in one part of the surface, in columns, with bounds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/quantised.h"
#include "core/curve/curve_blocks.h"
#include "core/progressive/stratum_bounds.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// The first chunk has the points of the 4^kChunkLevels lowest ranks.
inline constexpr int kChunkLevels = 6;
inline constexpr std::size_t kChunkStrata = std::size_t{1} << 2 * kChunkLevels;
/// A chunk's points in curve order are this many runs of equal length; each run has bounds of its own.
inline constexpr std::size_t kChunkRuns = 16;

/// Names a chunk. The first chunk has level kChunkLevels and index 0. A chunk of a higher level holds the ranks [4^(level - 1),
/// 4^level) of the stratum `index` of level - kChunkLevels. Its children are four chunks of the next level, 4 index to 4 index +
/// 3: the higher ranks in the quarters of its stratum.
struct ChunkId {
  int level = kChunkLevels;
  std::uint64_t index = 0;

  /// Returns the lowest rank that a point of the chunk may have.
  std::uint64_t first_rank() const { return level == kChunkLevels ? 0 : std::uint64_t{1} << 2 * (level - 1); }
  ChunkId child(std::uint64_t quarter) const { return {level + 1, 4 * index + quarter}; }
  auto operator<=>(const ChunkId&) const = default;
};

/// Points of a chunk, in curve order.
struct RankChunk {
  ChunkId id;
  std::vector<float> x, y, z;       // relative to the curve's origin
  std::vector<Snorm16> nx, ny, nz;  // unit normals
  std::vector<std::uint32_t> rank;
  std::vector<std::uint32_t> vertex;          // of the curve
  std::vector<std::uint32_t> curve_position;  // highest 32 bits of RankedPoint::curve_position; no two points share them
  CurveBlocks bounds;  // of each run: bounds of all points in its strata, those of deeper chunks too; without area
  std::array<std::uint32_t, kChunkRuns> first_vertex{}, last_vertex{};  // of each run's strata on the curve, both included

  std::size_t size() const { return x.size(); }
  std::size_t run_size() const { return size() / kChunkRuns; }
};

/// Makes a chunk from the kChunkStrata points of level id.level in the chunk's stratum, in curve order. Points of lower levels,
/// which belong to other chunks, are left out.
RankChunk make_chunk(const ChunkId& id, std::span<const RankedPoint> points, const StratumBounds& bounds);

}  // namespace curvecast
