// The border of a disc on the border of the unit square.
#pragma once

#include <vector>

#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// uv of every vertex: those of the border once around the square's sides, counter-clockwise, with one of them on each corner and
/// between those by arc length; (0, 0) for all others. The corners lie a quarter of the border apart, the first at its start;
/// each may be up to `play` (of the border's length, below an eighth) off where the border turns more like the corner of a
/// square.
std::vector<Vec2d> square_border(const DiscMesh& disc, double play = 0);

}  // namespace curvecast
