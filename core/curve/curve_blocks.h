// The curve in blocks of a few vertices that follow one another. A view looks at the blocks first, and only where it must at
// their vertices: a sixteenth of the work, and of the bytes.
#pragma once

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/column.h"
#include "core/base/vec.h"

namespace curvecast {

struct SurfaceCurve;

/// Vertices of a block; the last block may have fewer.
inline constexpr std::size_t kBlockSize = 16;

inline std::size_t block_count(std::size_t vertices) { return (vertices + kBlockSize - 1) / kBlockSize; }

/// Counts, in parts of which a block's mass has kWhole, what lies on the vertices up to and including each: ascending, kWhole
/// from the last vertex with mass on.
struct MassCodes {
  static constexpr std::int16_t kWhole = 32'767;

  std::int16_t through[kBlockSize];

  /// Converts a part of the mass, 0 <= part < 1, to the parts that are counted.
  static std::int32_t part(float part) { return static_cast<std::int32_t>(part * kWhole); }

  /// Returns the vertex (0 .. kBlockSize - 1) below which that part of the mass lies; always one with mass.
  std::size_t vertex(std::int32_t part) const {
#ifdef __SSE2__
    // Vertices after that part are a bit each, and the first of them is the one.
    const __m128i code = _mm_set1_epi16(static_cast<std::int16_t>(part));
    const __m128i first = _mm_cmpgt_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(through)), code);
    const __m128i second = _mm_cmpgt_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(through + 8)), code);
    return static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(first, second)))));
#else
    std::size_t count = 0;
    for (const std::int16_t code : through) count += code <= part ? 1 : 0;
    return count;
#endif
  }
};

/// A mass on every vertex (a density times its element of area), summed by blocks.
struct BlockMass {
  Column<float> sum;        // B
  Column<float> largest;    // B: on one vertex
  Column<MassCodes> codes;  // B
  double total = 0;         // sum of all
  float most = 0;           // largest of all

  std::size_t byte_size() const { return sum.size() * (2 * sizeof(float) + sizeof(MassCodes)); }
};

/// Blocks that are summed at once, one in each lane.
inline constexpr std::size_t kBlockLanes = 8;

/// What sum_blocks() makes of blocks.
struct MassOfBlocks {
  float sum[kBlockLanes], largest[kBlockLanes];
  MassCodes codes[kBlockLanes];
};

/// Sums the masses of whole blocks, that of vertex i of block k in mass[i][k]: not negative, 0 where a block has no more
/// vertices. Where a block's sum is not finite its codes mean nothing.
void sum_blocks(const float (&mass)[kBlockSize][kBlockLanes], MassOfBlocks& out);

/// Sums density times area by blocks; no density means 1 everywhere. Neither is negative, and both are as long as the curve.
BlockMass block_mass(std::span<const float> density, std::span<const float> area);

/// Where the blocks lie and what they face; B entries each.
struct CurveBlocks {
  Column<float> x, y, z;     // the middle of the box around the vertices, relative to the curve's origin
  Column<float> radius;      // the vertices lie within this of it
  Column<float> nx, ny, nz;  // unit: the vertices' mean normal
  Column<float> spread;      // their normals, those beside creases too, lie within this of it, as points on the unit sphere
  BlockMass area;            // of density 1

  std::size_t size() const { return x.size(); }
  std::size_t byte_size() const;
};

/// Makes the blocks of a curve whose positions, normals and areas are there. Runs on all threads of the arena.
CurveBlocks build_blocks(const SurfaceCurve& curve);

}  // namespace curvecast
