// A chart's triangles sorted into the cells of a grid over the parameter square.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// Lists for each cell of the grid of 2^level x 2^level squares, row by row from below, the triangles that overlap or touch it,
/// ascending. 0 <= level <= 8. The same for any number of threads.
std::vector<std::vector<std::uint32_t>> bin_triangles(std::span<const ParameterTriangle> triangles, int level);

}  // namespace curvecast
