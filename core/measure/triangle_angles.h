// How regular the triangles of a mesh are.
#pragma once

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Of the smallest angle of each triangle, which is 60 degrees at most; in degrees.
struct LeastAngles {
  double median = 0;
  double percentile_1 = 0;  // one triangle of a hundred has less
  double least = 0;
  double below_20 = 0;  // share of the triangles with less than 20 degrees
};

/// Triangles without an area have 0. Zeros for a mesh without triangles.
LeastAngles least_angles(const MeshView& mesh);

}  // namespace curvecast
