// Maps the curve's vertices from the parameter square onto the surface (paper, section 3.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"
#include "core/curve/surface_colour.h"
#include "core/curve/surface_curve.h"
#include "core/curve/vertex_record.h"
#include "core/flatten/flatten.h"
#include "core/mesh/curvature.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// What finds the triangle under a leaf's centre.
enum class Mapper : std::uint8_t {
  kExact,     // the quadtree's own lists of triangles: locate_centres()
  kIdBuffer,  // pictures of the parameter mesh with a colour for each triangle, checked near edges
};

/// The exact mapper: writes to `under` (L entries) the triangle of the disc that holds each leaf's centre. Of the leaf's own
/// triangles it is the one in which the centre lies deepest, so that rounding on a shared side does no harm.
void locate_centres(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<std::uint32_t> under);

/// What is known of the surface; all that it is made of must outlive it.
struct SurfaceData {
  SurfaceData(const TriangleMesh& of_mesh, const DifferentialGeometry& geometry, const MeshAttributes& of_attributes,
              const SurfaceColour* of_colour = nullptr)
      : mesh(of_mesh), attributes(of_attributes), colour(of_colour), records(vertex_records(geometry)) {}

  const TriangleMesh& mesh;
  const MeshAttributes& attributes;  // of the mesh
  const SurfaceColour* colour;       // may be null
  Column<VertexRecord> records;
};

/// Writes entries [offset, offset + L) of `curve`: position, normal, curvatures and their direction, face and barycentric weights
/// of every leaf's centre, its key and level; where `data.colour` is not null the surface's colour, averaged over about the
/// leaf's area; and the mesh's scalars, as many as curve.scalars has. `under`: the triangle of the chart's disc under each
/// centre. The curve's columns are large enough and its origin is set.
void map_to_surface(const SurfaceData& data, const Chart& chart, std::span<const ParameterTriangle> triangles,
                    const QuadtreeLeaves& leaves, std::span<const std::uint32_t> under, std::size_t offset, SurfaceCurve& curve);

}  // namespace curvecast
