// Normals beside creases: edges so sharp that no smooth surface is meant. Each side of a crease has normals of its own, as a face
// of a box has one that does not lean towards its neighbours'.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Faces whose normals' cosine is below this meet at a crease: 45 degrees.
inline constexpr double kCreaseCosine = 0.70710678118654752;

/// The normal of a vertex within one part of the faces around it.
struct CreaseNormal {
  std::uint32_t vertex;
  Vec3f normal;  // unit length, angle-weighted mean of the part's faces
};

/// A face with a corner that has a normal other than its vertex.
struct CreaseFace {
  std::uint32_t face;
  std::array<std::uint32_t, 3>
      normals;  // of its corners: numbers of CreaseNormals::normals, or kNone where it is the vertex's own
};

struct CreaseNormals {
  std::vector<CreaseNormal> normals;  // in order of vertex
  std::vector<CreaseFace> faces;      // in order of face
};

/// The normals of all vertices at which creases divide the faces around them into two parts or more. A crease that ends at a
/// vertex inside the surface divides nothing there.
CreaseNormals crease_normals(const TriangleMesh& mesh);

}  // namespace curvecast
