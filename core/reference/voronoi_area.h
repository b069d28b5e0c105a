// Voronoi area elements: the area nearest to each curve vertex among its neighbours on the surface (paper, section 3.4; Meyer,
// Desbrun, Schroeder, Barr, "Discrete differential-geometry operators for triangulated 2-manifolds", 2002, section 3.3).
#pragma once

#include <cstdint>
#include <span>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"
#include "core/flatten/flatten.h"

namespace curvecast {

/// The curve vertices of one disc, L entries each.
struct LeafVertices {
  std::span<const float> x, y, z;        // on the surface, relative to `origin`
  std::span<const std::uint32_t> under;  // triangle of the disc
  Vec3d origin;
};

/// Writes each leaf's mixed Voronoi area (with Meyer et al.'s rule for obtuse triangles) to `area` (L entries, squared units);
/// returns their sum before they are rounded to floats. `triangles`: of the chart. The same for any number of threads.
///
/// Fans over all eight neighbours don't add up: where the parameterisation shears they count up to a sixth of the area twice, and
/// leaves of different sizes overlap or leave gaps. So the triangles are those of the quadtree's dual (Ju, Losasso, Schaefer,
/// Warren, "Dual contouring of Hermite data", 2002): around a corner where four leaves meet their four vertices, divided by the
/// diagonal that Delaunay's criterion chooses; around a corner on the side of a larger leaf three. They fill the square; leaves
/// on its border reach up to it. Nor do the triangles' own areas add up to the surface's: where leaves are sheared thin ones
/// stand askew on it, as in Schwarz's lantern, and counted 1.5 % too much on one mesh of 15K faces. So the corners of a triangle
/// share, in Voronoi's proportions, the area of the surface beneath it, taken as its area in the square times the mean of the
/// area ratios at its corners.
double voronoi_areas(const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
                     const LeafVertices& vertices, std::span<float> area);

}  // namespace curvecast
