// Moves the vertices of a mesh along the surface that they lie on, so that its triangles become more regular. Source: Botsch,
// Kobbelt, "A remeshing approach to multiresolution modeling" (2004), with weights that keep what is dense dense.
#pragma once

#include <span>

#include "core/base/execution_context.h"
#include "core/mesh/surface_walk.h"
#include "core/remesh/halfedge_mesh.h"

namespace curvecast {

/// Moves every vertex `rounds` times within its tangent plane, towards the mean of its neighbours, each weighted by the square
/// root of the area around it; brings it back to the surface; and turns edges by their angles. Vertices on borders and features
/// stay. A move that would turn a triangle over is left out. `places`: of each vertex on `surface`, for all that the mesh has;
/// brought up to date. The same for any number of threads.
void relax(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<WalkPlace> places, int rounds,
           const ExecutionContext& context = {});

}  // namespace curvecast
