// Along which tangent a surface bends most, at its vertices. Source: Theisel, Rössl, Zayer, Seidel, "Normal based estimation of
// the curvature tensor for triangular meshes" (2004): the vertices' normals, linear over each face, have the curvature as
// derivative.
#pragma once

#include <span>

#include "core/mesh/curvature.h"
#include "core/mesh/triangle_mesh.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {

/// Writes for each vertex as direction_max the unit tangent, in one of its two senses, along which the signed curvature is
/// largest (positive where the surface is convex), of the area-weighted mean of its faces' tensors; any tangent where all are
/// equal. `geometry`: V entries; their normals are there.
void principal_directions(const TriangleMesh& mesh, const VertexFans& fans, const ExecutionContext& context,
                          std::span<VertexGeometry> geometry);

}  // namespace curvecast
