// Inverts the cumulative density along the curve, like histogram equalisation (paper, section 3.4).
#pragma once

#include <cstdint>
#include <span>

namespace curvecast {

/// For each q_i (ascending, in [0, 1)) the first curve vertex at which the cumulative sum of density[l] * area[l] exceeds
/// q_i times the whole sum; written to `vertices` (as many as q), ascending. Vertices without density are never chosen.
/// Returns the whole sum; where it is not positive and finite `vertices` is left alone. Preconditions: density and area are
/// equally long and not negative.
double equalise(std::span<const float> density, std::span<const float> area, std::span<const double> q,
                std::span<std::uint32_t> vertices);

}  // namespace curvecast
