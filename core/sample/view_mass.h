// The mass that a view puts on a curve: its density times the area elements (paper, section 3.4: the terms of the cumulative
// sum). It is found block by block, and vertex by vertex only where that moves a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/capacity.h"
#include "core/curve/surface_curve.h"
#include "core/density/view_factor.h"

namespace curvecast {

/// The masses of a curve's blocks under a view; B is the number of blocks.
struct ViewMass {
  static constexpr std::uint32_t kShared = std::numeric_limits<std::uint32_t>::max();

  double total = 0;        // sum of all masses
  float largest = 0;       // some vertex has at least this mass
  std::vector<float> sum;  // B: mass of each block; or none, where the fixed mass's sums hold
  // B: index of each block's codes in own_codes, or kShared where the fixed mass's codes hold; or none, where they hold
  // everywhere.
  std::vector<std::uint32_t> codes;
  std::vector<MassCodes> own_codes;  // of the blocks whose vertices were looked at
  std::vector<float> moved;          // B: how much of a block's mass would lie elsewhere at most, if it counted as its middle
  std::vector<std::uint32_t> close;  // its first entries: the blocks whose vertices were looked at, ascending

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [t, l, s, c, o, m, k] = *this;
    return capacity_bytes(s, c, o, m, k);
  }
  std::span<const float> sums(const BlockMass& fixed) const { return sum.empty() ? std::span<const float>(fixed.sum) : sum; }
  const MassCodes& codes_of(const BlockMass& fixed, std::size_t block) const {
    if (codes.empty()) return fixed.codes[block];
    const std::uint32_t own = codes[block];
    return *(own == kShared ? fixed.codes.data() + block : own_codes.data() + own);
  }
};

/// Writes a fixed mass to `out` as it is, under no view. The memory of `out` is used again.
void fixed_mass(const BlockMass& fixed, ViewMass& out);

/// Writes to `out` a fixed mass times the view's factor. `density`: the fixed density at the vertices, empty where it is 1;
/// `fixed`: that density times area. Where the view changes so little within a block that less than a quarter of one of `points`
/// points comes to lie elsewhere, the factor of the block's middle counts for all of it; where the outline passes, and where
/// points are dense, its vertices count one by one.
void view_mass(const SurfaceCurve& curve, std::span<const float> density, const BlockMass& fixed, const ViewFactor& view,
               std::uint64_t points, ViewMass& out);

}  // namespace curvecast
