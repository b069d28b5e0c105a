// The curve in blocks of a few vertices that follow one another. A view looks at the blocks first, and only where it must at
// their vertices: a sixteenth of the work, and of the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/column.h"
#include "core/vec.h"

namespace curvecast {

struct SurfaceCurve;

/// Vertices of a block; the last block may have fewer.
inline constexpr std::size_t kBlockSize = 16;

inline std::size_t block_count(std::size_t vertices) { return (vertices + kBlockSize - 1) / kBlockSize; }

/// Of a block's mass what lies on its vertices up to and including each, in kWhole parts: ascending, kWhole from the last vertex
/// with mass on.
struct MassCodes {
  static constexpr std::int16_t kWhole = 32'767;

  std::int16_t through[kBlockSize];

  /// The vertex (0 .. kBlockSize - 1) below which `part` of the mass lies, 0 <= part < 1; always one with mass.
  std::size_t vertex(float part) const {
    // Counts the vertices before it, eight at a time: a comparison that holds gives -1.
    using Codes = std::int16_t __attribute__((vector_size(16)));
    Codes first, second;
    std::memcpy(&first, through, sizeof(Codes));
    std::memcpy(&second, through + 8, sizeof(Codes));
    const auto code = static_cast<std::int16_t>(part * kWhole);
    const Codes counts = -((first <= code) + (second <= code));
    std::uint64_t halves[2];
    std::memcpy(halves, &counts, sizeof(halves));
    return (halves[0] + halves[1]) * 0x0001000100010001u >> 48;
  }
};

/// A mass on every vertex (a density times its element of area), summed by blocks.
struct BlockMass {
  Column<float> sum;        // B
  Column<float> largest;    // B: on one vertex
  Column<MassCodes> codes;  // B

  std::size_t byte_size() const { return sum.size() * (2 * sizeof(float) + sizeof(MassCodes)); }
};

/// Sums the masses of a block's n vertices, 1 <= n <= kBlockSize.
struct MassOfBlock {
  float sum, largest;
  MassCodes codes;
};
MassOfBlock sum_block(const float* mass, std::size_t n);

/// Of density times area; no density means 1 everywhere. Both are not negative, and as long as the curve.
BlockMass block_mass(std::span<const float> density, std::span<const float> area);

/// Where the blocks lie and what they face; B entries each.
struct CurveBlocks {
  Column<float> x, y, z;     // the middle of the box around the vertices, relative to the curve's origin
  Column<float> radius;      // the vertices lie within this of it
  Column<float> nx, ny, nz;  // unit: the vertices' mean normal
  Column<float> spread;      // their normals lie within this of it, as points on the unit sphere
  BlockMass area;            // of density 1

  std::size_t size() const { return x.size(); }
  std::size_t byte_size() const;
};

/// Of a curve whose positions, normals and areas are there. Runs on all threads of the arena.
CurveBlocks build_blocks(const SurfaceCurve& curve);

}  // namespace curvecast
