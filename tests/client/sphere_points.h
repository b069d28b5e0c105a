// Point sets to test with.
#pragma once

#include <cstddef>

#include "client/lib/points.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// `count` points on the unit sphere along a spiral, with normals and radii from 0.01 to 0.02.
Points sphere_points(std::size_t count);
/// Gives every point a colour.
void add_colours(Points* points);

/// As raw and as Draco blocks.
v1::PointBlock raw_block(const Points& points);
v1::PointBlock draco_block(const Points& points, int position_bits = 16);

}  // namespace curvecast::client
