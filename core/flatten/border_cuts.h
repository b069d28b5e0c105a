// Tells a disc's cuts from the borders that the mesh itself has.
#pragma once

#include <vector>

#include "core/flatten/disc_mesh.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Tells for every border vertex of the disc whether the edge from it to the next one is a cut: the edge of the mesh on which it
/// lies has a twin. `mesh` is the one that the disc was cut from. Precondition: a disc as of cut_to_disc.
std::vector<bool> border_cuts(const TriangleMesh& mesh, const DiscMesh& disc);

}  // namespace curvecast
