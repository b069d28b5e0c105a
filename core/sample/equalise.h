// Finds the curve vertices of a point set by inverting the cumulative density along the curve, as histogram equalisation does
// (paper, section 3.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/capacity.h"
#include "core/curve/curve_blocks.h"
#include "core/sample/view_mass.h"

namespace curvecast {

/// Memory that equalise() uses again.
struct EqualiseScratch {
  std::vector<std::uint32_t> block;  // at most N + 1

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [b] = *this;
    return capacity_bytes(b);
  }
};

/// Writes to vertices[i] the curve vertex on which the cumulative mass exceeds q[i] times the whole. q is ascending, in [0, 1);
/// `vertices` has as many entries and is ascending too. Within a block the mass lies where its codes say, to a 32,767th. Vertices
/// without mass are never chosen. `fixed`: the mass from which view_mass() made `mass`. Leaves `vertices` alone where the whole
/// mass is not positive and finite. Fastest where q[i] is about i / N.
void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices,
              EqualiseScratch& scratch);
inline void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices) {
  EqualiseScratch scratch;
  equalise(mass, fixed, q, vertices, scratch);
}

}  // namespace curvecast
