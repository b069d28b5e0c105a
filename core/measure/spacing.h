// How far points keep from each other. Source: Lagae and Dutre, "A comparison of methods for generating Poisson disk
// distributions" (2008), section 2.3.
#pragma once

#include <span>
#include <vector>

#include "core/measure/point_cloud.h"

namespace curvecast {

/// Returns r_max of Lagae and Dutre: half the distance between neighbours where n points keep as far apart as they can on a plane
/// of that area, in a hexagonal lattice. In the units whose square the area has.
double packing_radius(double area, std::size_t n);

/// Summarises every point's distance to its nearest neighbour: straight through space, over 2 r_max, which makes it 1 in the
/// hexagonal lattice.
struct NeighbourDistances {
  double min = 0;  // the relative radius rho
  double mean = 0;
  double max = 0;
};

/// Measures the distances among all points. Preconditions: at least two points; area > 0.
NeighbourDistances neighbour_distances(double area, const PointCloud& points);

/// Measures the distances among points on the same side: two points are neighbours only where the surface faces the same way, so
/// that where it is thinner than the points are apart, those on the other side don't count: normals that differ by 120 degrees at
/// most. (Sides of a sheet differ by 180; a sharp crease, over which points are neighbours all the same, rarely by more than
/// 120.) `normals`: of the surface at each point. Points without such a neighbour among the 64 nearest are left out. All 0 when
/// every point is. Preconditions as above.
NeighbourDistances neighbour_distances_on_side(double area, const PointCloud& points, std::span<const Vec3f> normals);

}  // namespace curvecast
