// Cuts a polygon in space into triangles.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// Appends the triangles of the polygon with the given corners (n >= 3, in order, may be concave or not quite planar) as indices
/// into `corners`, in the polygon's orientation. n - 2 triangles. Quads take the shorter diagonal that folds nothing; larger
/// polygons go to CGAL's triangulate_faces (a constrained Delaunay triangulation in their plane), and become a fan where
/// they cross themselves.
void triangulate_polygon(std::span<const Vec3d> corners, std::vector<Triangle>& triangles);

}  // namespace curvecast
