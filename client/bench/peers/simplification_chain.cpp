#include "client/bench/peers/simplification_chain.h"

#include <meshoptimizer.h>

#include <cstdint>
#include <utility>

#include "core/base/vec.h"

namespace curvecast::cli::bench {

std::vector<std::size_t> simplification_chain(const TriangleMesh& mesh, std::size_t least_faces) {
  constexpr double kHardlyFewer = 0.95;
  std::vector<Vec3f> positions;
  positions.reserve(mesh.vertex_count());
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p.cast<float>());
  std::vector<std::uint32_t> corners, fewer;
  corners.reserve(3 * mesh.face_count());
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::vector<std::size_t> levels;
  while (corners.size() / 3 > least_faces) {
    fewer.resize(corners.size());      // meshoptimizer writes no more, but may write as many on the way
    constexpr float kAnyError = 1e6f;  // of the mesh's extent: levels end by their number of triangles
    const std::size_t left = meshopt_simplify(fewer.data(), corners.data(), corners.size(), positions.front().data(),
                                              positions.size(), sizeof(Vec3f), corners.size() / 6 * 3, kAnyError, 0, nullptr);
    if (static_cast<double>(left) > kHardlyFewer * static_cast<double>(corners.size())) break;
    fewer.resize(left);
    std::swap(corners, fewer);
    levels.push_back(corners.size() / 3);
  }
  return levels;
}

}  // namespace curvecast::cli::bench
