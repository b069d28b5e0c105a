// The edges along which a connected mesh is cut open to a disc.
#pragma once

#include <vector>

#include "core/flatten/cut_to_disc.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Marks the inner edges to cut, on both of their halfedges (3 F flags). The mesh is connected; cutting along the marked edges
/// leaves one disc with at least two border edges.
std::vector<bool> cut_graph(const TriangleMesh& mesh, const CutOptions& options);

}  // namespace curvecast
