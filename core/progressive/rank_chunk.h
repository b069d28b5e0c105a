// Ranked points as a view reads them: those that one level adds in one part of the surface, in columns, with bounds.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/base/colour.h"
#include "core/base/quantised.h"
#include "core/density/camera_frame.h"
#include "core/progressive/stratum_bounds.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// The first chunk has the points of the 4^kChunkLevels lowest ranks.
inline constexpr int kChunkLevels = 5;
inline constexpr std::size_t kChunkStrata = std::size_t{1} << 2 * kChunkLevels;
/// A chunk's points lie in layers, of ascending rank: a layer has one point in each of these strata, in curve order.
inline constexpr std::size_t kLayerStrata = kChunkStrata / 4;
/// A chunk's stratum has this many parts of equal area, the runs; each has bounds of its own.
inline constexpr std::size_t kChunkRuns = 16;
/// Points of each run in a layer.
inline constexpr std::size_t kRunPoints = kLayerStrata / kChunkRuns;

/// Ranks of these levels are kept as they are.
inline constexpr int kWholeRankLevels = 15;

/// Names a chunk. The first chunk has level kChunkLevels and index 0. A chunk of a higher level holds the ranks [4^(level - 1),
/// 4^level) of the stratum `index` of level - kChunkLevels. Its children are four chunks of the next level, 4 index to 4 index +
/// 3: the higher ranks in the quarters of its stratum.
struct ChunkId {
  int level = kChunkLevels;
  std::uint64_t index = 0;

  /// Returns how many ranks there are from the lowest in a layer to the lowest in the next.
  std::uint64_t layer_ranks() const { return std::uint64_t{1} << 2 * (level - 1); }
  /// Returns the lowest rank that a point of a layer may have.
  std::uint64_t first_rank(std::size_t layer = 0) const { return (layer + (level == kChunkLevels ? 0 : 1)) * layer_ranks(); }
  /// Chunks keep ranks in steps of this, rounded down: they fit signed 32-bit integers, which vector code turns to floats.
  std::uint64_t rank_step() const { return level > kWholeRankLevels ? std::uint64_t{1} << 2 * (level - kWholeRankLevels) : 1; }
  ChunkId child(std::uint64_t quarter) const { return {level + 1, 4 * index + quarter}; }
  /// Return the first and the last curve position in the chunk's stratum.
  std::uint64_t first_position() const { return level == kChunkLevels ? 0 : index << (64 - 2 * (level - kChunkLevels)); }
  std::uint64_t last_position() const {
    return level == kChunkLevels ? ~std::uint64_t{0}
                                 : first_position() + ((std::uint64_t{1} << (64 - 2 * (level - kChunkLevels))) - 1);
  }
  /// Returns which of a layer's strata a curve position in the chunk's stratum lies in.
  std::size_t stratum_in_layer(std::uint64_t curve_position) const {
    return curve_position >> (64 - 2 * (level - 1)) & (kLayerStrata - 1);
  }
  auto operator<=>(const ChunkId&) const = default;
};

/// Returns how many points a chunk of a level has.
constexpr std::size_t chunk_points(int level) { return level == kChunkLevels ? kChunkStrata : kChunkStrata - kLayerStrata; }

/// Returns how many chunks a level from kChunkLevels on has on the whole surface.
constexpr std::uint64_t chunks_of_level(int level) { return std::uint64_t{1} << 2 * (level - kChunkLevels); }

/// When a chunk was last looked at, in growths of its tree. Selections write it while others read.
class LastUse {
 public:
  LastUse() = default;
  LastUse(const LastUse& other) : growth_(other.get()) {}
  LastUse& operator=(const LastUse& other) {
    set(other.get());
    return *this;
  }
  std::uint64_t get() const { return growth_.load(std::memory_order_relaxed); }
  void set(std::uint64_t growth) const {
    if (get() != growth) growth_.store(growth, std::memory_order_relaxed);
  }

 private:
  mutable std::atomic<std::uint64_t> growth_ = 0;
};

/// Bounds of each run of a chunk: of all points in its strata, those of deeper chunks too. See CurveBlocks.
struct RunBounds {
  float x[kChunkRuns], y[kChunkRuns], z[kChunkRuns], radius[kChunkRuns];
  float nx[kChunkRuns], ny[kChunkRuns], nz[kChunkRuns], spread[kChunkRuns];
  float detail[kChunkRuns];  // the largest PictureDetail

  BlockColumns columns() const { return {x, y, z, radius, nx, ny, nz, spread}; }
};

/// Points of a chunk, layer by layer, in curve order in each. What a selection reads of a run fills lines of the caches, or
/// halves.
struct RankChunk {
  ChunkId id;
  LastUse used;
  AlignedVector<float> x, y, z;       // relative to the curve's origin
  AlignedVector<Snorm16> nx, ny, nz;  // unit normals
  AlignedVector<std::uint32_t> rank;  // in steps of id.rank_step()
  AlignedVector<Unorm16> detail;      // PictureDetail
  AlignedVector<Direction8> beside;   // see SurfaceCurve::beside; empty when no point is near a crease
  std::uint16_t runs_beside = 0;      // a bit for each run that has points near a crease
  RunBounds bounds;
  std::vector<std::uint64_t> curve_position;
  std::vector<std::uint32_t> vertex;                                    // of the curve: in whose leaf the point lies
  std::vector<std::uint32_t> face;                                      // of the repaired mesh
  std::vector<Unorm16> weight_1, weight_2;                              // barycentric: of the face's second and third corner
  std::vector<Rgba8> colour;                                            // of the surface; empty when the mesh has none
  std::array<std::uint32_t, kChunkRuns> first_vertex{}, last_vertex{};  // of each run's strata on the curve, both included

  std::size_t size() const { return x.size(); }
  std::size_t layers() const { return size() / kLayerStrata; }
  /// Returns a point's rank, as far as it is kept: the exact one down to level kWholeRankLevels.
  std::uint64_t rank_of(std::size_t point) const { return rank[point] * id.rank_step(); }
};

static_assert(kChunkRuns <= 16);
static_assert(kRunPoints * sizeof(float) == kCacheLine);

/// Fills what a chunk has of the curve at its points' vertices: detail, beside and runs_beside.
void fill_from_curve(const SurfaceCurve& curve, RankChunk& chunk);

/// Makes a chunk from the kChunkStrata points of level id.level in the chunk's stratum. Points of lower levels, which belong to
/// other chunks, are left out.
RankChunk make_chunk(const ChunkId& id, std::span<const RankedPoint> points, const StratumBounds& bounds,
                     const LeafSurface& surface);

}  // namespace curvecast
