// Inverts the cumulative density along the curve, like histogram equalisation (paper, section 3.4).
#pragma once

#include <cstdint>
#include <span>

namespace curvecast {

/// Of density times area over the curve.
struct Mass {
  double total = 0;
  float largest = 0;  // on one vertex; the share of the points that it gets tells whether the curve is fine enough
};

/// For each q_i (ascending, in [0, 1)) the first curve vertex at which the cumulative sum of density[l] * area[l] exceeds
/// q_i times the whole sum; written to `vertices` (as many as q), ascending. Vertices without density are never chosen.
/// Where the whole sum is not positive and finite `vertices` is left alone. Preconditions: density and area are equally long and
/// not negative.
Mass equalise(std::span<const float> density, std::span<const float> area, std::span<const double> q,
              std::span<std::uint32_t> vertices);

}  // namespace curvecast
