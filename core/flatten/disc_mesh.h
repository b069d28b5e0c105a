// A piece of the surface that has been cut open to a topological disc.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct DiscMesh {
  std::vector<Triangle> triangles;     // T, over the disc's own vertices
  std::vector<std::uint32_t> face_of;  // T: face of the mesh that holds the triangle; splitting edges makes several share one
  std::vector<Vec3d> positions;        // V; new ones, where edges were split, lie on the surface too
  std::vector<std::uint32_t> border;   // the only border loop, surface on the left; at least 4 vertices, each once

  std::size_t vertex_count() const { return positions.size(); }
};

}  // namespace curvecast
