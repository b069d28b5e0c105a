// Moves the vertices of a mesh off the surface, so that its triangles lie as near to the surface as they can.
#pragma once

#include <span>

#include "core/base/execution_context.h"
#include "core/mesh/surface_walk.h"
#include "core/remesh/halfedge_mesh.h"

namespace curvecast {

/// Least squares: places evenly spread over the mesh's triangles, as many as the surface has faces or more, look for the nearest
/// of the surface; their distances from its plane there are made as small as vertices can make them, weighted by area, and a few
/// rounds of it. Where this says nothing, along the surface, vertices stay. Vertices on borders and features stay, and moves that
/// would turn a triangle over are left out. Source of the idea: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh optimization"
/// (1993), with distances from planes. `mesh`: compacted. `places`: of each vertex on `surface`. The same for any number of
/// threads. Cancelled, it is as it was after some round.
void fit(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<const WalkPlace> places, const ExecutionContext& context = {});

}  // namespace curvecast
