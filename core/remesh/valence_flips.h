// Turns edges so that more vertices have six neighbours. Source: Surazhsky, Gotsman, "Explicit surface remeshing" (2003).
#pragma once

#include "core/remesh/halfedge_mesh.h"

namespace curvecast {

/// Turns edges for as long as the squares of what vertices have more or less than six neighbours (four on borders) add up to less
/// by it, where no triangle gets an angle of more than 120 degrees or folds over, and the topology allows it.
void flip_to_valence(HalfedgeMesh& mesh);

}  // namespace curvecast
