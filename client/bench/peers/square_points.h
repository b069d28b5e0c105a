// Well-known low-discrepancy points of the unit square: peers to compare with where there is no surface.
// Sources: Niederreiter, "Random Number Generation and Quasi-Monte Carlo Methods" (1992), sections 3.1 and 4.5; Hammersley,
// "Monte Carlo methods for solving multivariable problems" (1960).
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/vec.h"

namespace curvecast::cli::bench {

/// Returns the first n points of Niederreiter's two-dimensional sequence in base 2, in [0, 1)^2: those of the polynomials x and
/// x + 1, which are Sobol's too. The first 4^k lie one in each of as many equal squares. n < 2^32.
std::vector<Vec2d> niederreiter_points(std::size_t n);

/// Returns Hammersley's n points (i / n, i's binary digits mirrored at the point), in [0, 1)^2. n < 2^32.
std::vector<Vec2d> hammersley_points(std::size_t n);

}  // namespace curvecast::cli::bench
