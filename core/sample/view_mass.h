// The mass that a view puts on a curve: its density times the elements of area, block by block, looked at closely only where that
// moves a point (paper, section 3.4: the terms of the cumulative sum).
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

struct ViewMass {
  static constexpr std::uint32_t kShared = std::numeric_limits<std::uint32_t>::max();

  double total = 0;        // sum of all
  float largest = 0;       // on one vertex there is at least as much
  std::vector<float> sum;  // B, or none: those of the fixed mass
  // B, or none as with sum: which of own_codes a block has, or kShared: those of the fixed mass.
  std::vector<std::uint32_t> codes;
  std::vector<MassCodes> own_codes;  // of the blocks that were looked at closely
  std::vector<float> moved;          // B: how much of a block's mass would lie elsewhere at most, if it counted as its middle
  std::vector<std::uint32_t> close;  // the blocks that were looked at closely come first, ascending

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

/// A fixed mass as it is, under no view. What `out` held before is lost, its memory is used again.
void fixed_mass(const BlockMass& fixed, ViewMass& out);

/// Writes to `out` what a view leaves of a fixed mass, density times area; an empty `density` is 1. Where within a block the view
/// changes so little that less than a quarter of one of `points` points comes to lie elsewhere, the block counts as its middle;
/// where the outline passes, and where points crowd, its vertices count one by one.
void view_mass(const SurfaceCurve& curve, std::span<const float> density, const BlockMass& fixed, const ViewFactor& view,
               std::uint64_t points, ViewMass& out);

}  // namespace curvecast
