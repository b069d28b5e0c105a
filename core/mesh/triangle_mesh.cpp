#include "core/mesh/triangle_mesh.h"

#include "core/base/for_all.h"

namespace curvecast {

double triangle_area(const MeshView& mesh, std::size_t f) { return 0.5 * area_vector(mesh, f).norm(); }

double surface_area(const TriangleMesh& mesh, const ExecutionContext& context) {
  constexpr std::size_t kBlock = 1 << 18;
  double sum = 0;
  for_blocks_in_turn(context, mesh.face_count(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) sum += triangle_area(mesh, f);
  });
  return sum;
}

Box3d bounding_box(const TriangleMesh& mesh) {
  Box3d box;
  for (const Vec3d& p : mesh.positions) box.extend(p);
  return box;
}

}  // namespace curvecast
