// The middles of faces.
#pragma once

#include <cstddef>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

inline Vec3d centroid(const MeshView& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
}

}  // namespace curvecast
