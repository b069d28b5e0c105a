// How points that keep distances push one another, softly and from afar.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/vec.h"
#include "core/sample/point_blocks.h"

namespace curvecast {

inline constexpr float kRepulsionReach = 2;  // spacings

/// Finds how hard the points of a block are pushed, and where to: the sum of (1 - d / r)^2 over all points nearer than r, which
/// is kRepulsionReach times the smaller spacing of the two, d being the distance; weighed by how much they face the same way. For
/// any number of threads at a time, each with its scratch.
std::array<Vec3f, PointBlocks::kBlock> repulsion(const PointBlocks& points, std::size_t block, PointBlocks::Scratch& scratch);

}  // namespace curvecast
