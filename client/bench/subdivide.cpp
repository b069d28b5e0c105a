#include "client/bench/subdivide.h"

#include <algorithm>

#include "core/mesh/curvature.h"

namespace curvecast::cli::bench {
namespace {

/// The middle of the edge's cubic (equations 1 and 2 of the paper, for both ends).
Vec3d curved_middle(const Vec3d& a, const Vec3d& b, const Vec3d& normal_a, const Vec3d& normal_b) {
  const Vec3d along = b - a;
  return 0.5 * (a + b) - 0.125 * (along.dot(normal_a) * normal_a - along.dot(normal_b) * normal_b);
}

}  // namespace

TriangleMesh subdivide(const TriangleMesh& mesh) {
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  TriangleMesh fine;
  fine.positions = mesh.positions;
  std::vector<std::uint32_t> middle(mesh.twins.size());  // vertex in the middle of each halfedge
  for (std::uint32_t h = 0; h < middle.size(); ++h) {
    const std::uint32_t twin = mesh.twins[h];
    if (twin < h) {
      middle[h] = middle[twin];
      continue;
    }
    middle[h] = static_cast<std::uint32_t>(fine.positions.size());
    const std::uint32_t a = mesh.from(h), b = mesh.to(h);
    fine.positions.push_back(curved_middle(mesh.positions[a], mesh.positions[b], geometry[a].normal.cast<double>(),
                                           geometry[b].normal.cast<double>()));
  }
  fine.triangles.resize(4 * mesh.face_count());
  fine.twins.resize(12 * mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t h = 3 * f + i, previous = previous_halfedge(h);
      const std::uint32_t corner = 4 * f + i;
      fine.triangles[corner] = {mesh.triangles[f][i], middle[h], middle[previous]};
      fine.triangles[4 * f + 3][i] = middle[h];
      // The first half of h lies opposite to the second half of its twin, and so on.
      const std::uint32_t twin = mesh.twins[h], previous_twin = mesh.twins[previous];
      fine.twins[3 * corner] = twin == kNone ? kNone : 3 * (4 * (twin / 3) + (twin + 1) % 3) + 2;
      fine.twins[3 * corner + 2] = previous_twin == kNone ? kNone : 3 * (4 * (previous_twin / 3) + previous_twin % 3);
      const std::uint32_t inner = 3 * (4 * f + 3) + previous % 3;  // from the middle of `previous` to that of h
      fine.twins[3 * corner + 1] = inner;
      fine.twins[inner] = 3 * corner + 1;
    }
  }
  return fine;
}

}  // namespace curvecast::cli::bench
