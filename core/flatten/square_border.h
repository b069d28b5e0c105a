// The border of a disc on the border of the unit square.
#pragma once

#include <vector>

#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// uv of every vertex: those of the border once around the square's sides, counter-clockwise, by arc length, with one of them on
/// each corner; (0, 0) for all others.
std::vector<Vec2d> square_border(const DiscMesh& disc);

}  // namespace curvecast
