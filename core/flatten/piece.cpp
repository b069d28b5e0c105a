#include "core/flatten/piece.h"

#include "core/flatten/face_set.h"
#include "core/mesh/topology.h"

namespace curvecast {

TriangleMesh extract_piece(const TriangleMesh& mesh, std::span<const std::uint32_t> faces) {
  if (faces.size() == mesh.face_count()) return mesh;  // that is how repair() left it
  const FaceSet set(faces, mesh);
  TriangleMesh piece;
  piece.twins.resize(3 * faces.size());
  for (std::uint32_t h = 0; h < piece.twins.size(); ++h)
    piece.twins[h] = set.halfedge(mesh.twins[3 * faces[h / 3] + h % 3], h / 3);
  std::vector<std::uint32_t> fan_of_corner;
  piece.positions.resize(label_fans(piece.twins, fan_of_corner));
  piece.triangles.resize(faces.size());
  for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
    piece.triangles[h / 3][h % 3] = fan_of_corner[h];
    piece.positions[fan_of_corner[h]] = mesh.positions[mesh.triangles[faces[h / 3]][h % 3]];
  }
  return piece;
}

}  // namespace curvecast
