// Maps the curve's vertices from the parameter square onto the surface (paper, section 3.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/column.h"
#include "core/base/execution_context.h"
#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"
#include "core/curve/surface_colour.h"
#include "core/curve/surface_curve.h"
#include "core/flatten/chart_view.h"
#include "core/mesh/crease_normals.h"
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
/// None is found for some once the context is cancelled.
void locate_centres(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<std::uint32_t> under,
                    const ExecutionContext& context = {});

/// What is known of the surface, where it lies; what is looked at must outlive it.
struct SurfaceData {
  SurfaceData() = default;
  SurfaceData(const TriangleMesh& of_mesh, std::span<const VertexGeometry> of_geometry, const CreaseView& of_creases,
              const MeshAttributes& of_attributes, const SurfaceColour* of_colour = nullptr);

  /// Null where the face has none.
  const CreaseFace* crease_of(std::uint32_t face) const;
  /// Returns the normal at corner i of a face, whose crease_of() is `crease`: the one of its side of the crease, or its vertex's.
  const Vec3f& corner_normal(std::uint32_t face, std::size_t i, const CreaseFace* crease) const {
    const bool has_own = crease != nullptr && crease->normals[i] != kNone;
    return has_own ? creases.normals[crease->normals[i]].normal : geometry[mesh.triangles[face][i]].normal;
  }

  MeshView mesh;
  std::span<const VertexGeometry> geometry;     // of the mesh
  std::vector<std::span<const float>> scalars;  // each of the mesh's vertices
  const SurfaceColour* colour = nullptr;
  CreaseView creases;
  std::span<const std::uint32_t> borders;  // halfedges of the mesh without a twin, ascending
};

/// What the mapper wants to know of each triangle of a chart: whether it is a whole face, and whether creases meet that.
Column<std::uint8_t> triangle_kinds(const SurfaceData& data, const ChartView& chart);

/// Some leaves of one disc that follow one another on the curve, to be mapped in one go.
struct LeafBatch {
  static constexpr std::size_t kSize = 64;
  static constexpr std::size_t kSlack = 3;  // read beyond the last, and of no effect

  std::size_t count = 0;
  alignas(64) double u[kSize + kSlack] = {}, v[kSize + kSlack] = {};  // centres
  std::uint32_t under[kSize];                                         // the triangle of the disc under each centre
};

/// A place on the surface.
struct SurfacePlace {
  float position[3];         // relative to an origin
  float normal[3];           // unit length, smooth but for creases
  std::uint32_t face;        // of the repaired mesh
  float weight_1, weight_2;  // barycentric: of the face's second and third corner
};

/// Maps leaves of one disc; all that it is made of must outlive it.
class SurfaceMapper {
 public:
  /// `kinds`: see triangle_kinds().
  SurfaceMapper(const SurfaceData& data, const ChartView& chart, std::span<const std::uint8_t> kinds)
      : data_(data), disc_(chart), triangles_(chart), kinds_(kinds) {}

  /// Writes entries [at, at + batch.count) of the curve: position, normal, curvatures and their direction, face and barycentric
  /// weights of every centre; where the data has any, the surface's colour, averaged over about the leaf's area; and the mesh's
  /// scalars, as many as curve.scalars has. The curve's columns are large enough, its levels and its origin are set.
  void map(const LeafBatch& batch, std::size_t at, SurfaceCurve& curve) const;

  /// Writes the places of a batch, batch.count of them, relative to `origin`.
  void place(const LeafBatch& batch, const Vec3d& origin, SurfacePlace* places) const;

 private:
  const SurfaceData& data_;
  const ChartView disc_;
  const ChartTriangles triangles_;
  const std::span<const std::uint8_t> kinds_;
};

/// Maps all leaves of a disc to entries [offset, offset + L) of the curve, with their keys and levels. `under`: the triangle
/// under each centre. Some are missing once the context is cancelled.
void map_to_surface(const SurfaceMapper& mapper, const QuadtreeLeaves& leaves, std::span<const std::uint32_t> under,
                    std::size_t offset, SurfaceCurve& curve, const ExecutionContext& context = {});

}  // namespace curvecast
