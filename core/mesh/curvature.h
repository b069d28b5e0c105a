// Normals and curvatures at the vertices. Source: Meyer, Desbrun, Schröder, Barr, "Discrete differential-geometry operators for
// triangulated 2-manifolds" (2002).
#pragma once

#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {

/// At a vertex; half of a cache line, as the mapper asks for all of it at once.
struct VertexGeometry {
  Vec3f normal = Vec3f::UnitZ();               // unit length, angle-weighted mean of the faces'
  float curvature_min = 0, curvature_max = 0;  // principal curvatures, 1/unit; positive where the surface is convex
  Vec3f direction_max = Vec3f::UnitX();        // see principal_directions
};
static_assert(sizeof(VertexGeometry) == 32);

/// One for each vertex. Border vertices have no curvature of their own and take the mean of their inner neighbours'. Some are not
/// found once the context is cancelled.
std::vector<VertexGeometry> differential_geometry(const TriangleMesh& mesh);
std::vector<VertexGeometry> differential_geometry(const TriangleMesh& mesh, const VertexFans& fans,
                                                  const ExecutionContext& context);

/// The same with normals alone, in a third of the time: no curvatures, and no directions that mean anything.
std::vector<VertexGeometry> vertex_normals(const TriangleMesh& mesh, const VertexFans& fans,
                                           const ExecutionContext& context = {});

/// Returns the unit normal of a face.
Vec3f face_normal(const TriangleMesh& mesh, std::uint32_t f);

}  // namespace curvecast
