// Maps the curve's vertices from the parameter square onto the surface (paper, section 3.3), exactly, on the CPU.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/surface_colour.h"
#include "core/curve/surface_curve.h"
#include "core/flatten/flatten.h"
#include "core/mesh/curvature.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// What finds the triangle under a leaf's centre.
enum class Mapper : std::uint8_t {
  kExact,     // the quadtree's own lists of triangles
  kIdBuffer,  // pictures of the parameter mesh with a colour for each triangle, checked near edges
};

/// Writes entries [offset, offset + L) of `curve`: position, normal, curvatures and face of every leaf's centre, and its key and
/// level; where `colour` is not null also the surface's colour, averaged over about the leaf's area. The curve's arrays are large
/// enough and its origin is set. The triangle under a centre is found among the leaf's own.
void map_to_surface(const TriangleMesh& mesh, const DifferentialGeometry& geometry, const Chart& chart,
                    const QuadtreeLeaves& leaves, std::size_t offset, SurfaceCurve& curve, const SurfaceColour* colour = nullptr);

}  // namespace curvecast
