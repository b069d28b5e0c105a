#include "client/bench/peers/meshoptimizer.h"

#include <meshoptimizer.h>

#include <utility>

namespace curvecast::cli::bench {

std::vector<std::uint32_t> corners_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.face_count());
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  return corners;
}

void simplify(std::span<const Vec3f> positions, std::vector<std::uint32_t>& corners, std::size_t faces) {
  std::vector<std::uint32_t> fewer(corners.size());  // meshoptimizer writes no more, but may write as many on the way
  constexpr float kAnyError = 1e6f;                  // of the mesh's extent: it ends by the number of triangles
  fewer.resize(meshopt_simplify(fewer.data(), corners.data(), corners.size(), positions.front().data(), positions.size(),
                                sizeof(Vec3f), 3 * faces, kAnyError, 0, nullptr));
  std::swap(corners, fewer);
}

}  // namespace curvecast::cli::bench
