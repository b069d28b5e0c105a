// A piece of the surface that has been cut open to a topological disc.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Its positions, where edges were split, lie on the surface too.
struct DiscMesh : TriangleMesh {
  std::vector<std::uint32_t> face_of;  // F: face of the mesh that holds the triangle; splitting edges makes several share one
  std::vector<std::uint32_t> border;   // the only border loop, surface on the left; at least 4 vertices, each once
};

}  // namespace curvecast
