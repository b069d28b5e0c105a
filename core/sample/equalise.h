// Inverts the cumulative density along the curve, like histogram equalisation (paper, section 3.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/capacity.h"
#include "core/curve/curve_blocks.h"
#include "core/sample/view_mass.h"

namespace curvecast {

/// Memory that equalise() uses again; what it holds is equalise()'s own affair.
struct EqualiseScratch {
  std::vector<std::uint32_t> block;  // at most N + 1

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [b] = *this;
    return capacity_bytes(b);
  }
};

/// For each q_i (ascending, in [0, 1)) the curve vertex on which the cumulative mass exceeds q_i times the whole; written to
/// `vertices` (as many as q), ascending. Within a block the mass lies where its codes say, to a 32,767th. Vertices without mass
/// are never chosen. Where the whole mass is not positive and finite `vertices` is left alone. `fixed`: that which the mass was
/// made from. Fastest where q_i is about i / N.
void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices,
              EqualiseScratch& scratch);
inline void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices) {
  EqualiseScratch scratch;
  equalise(mass, fixed, q, vertices, scratch);
}

}  // namespace curvecast
