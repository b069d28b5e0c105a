#include "client/bench/peers/simplification_chain.h"

#include <cstdint>

#include "client/bench/peers/meshoptimizer.h"
#include "core/base/vec.h"

namespace curvecast::cli::bench {

std::vector<std::size_t> simplification_chain(const TriangleMesh& mesh, std::size_t least_faces) {
  constexpr double kHardlyFewer = 0.95;
  std::vector<Vec3f> positions;
  positions.reserve(mesh.vertex_count());
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p.cast<float>());
  std::vector<std::uint32_t> corners = corners_of(mesh);
  std::vector<std::size_t> levels;
  while (corners.size() / 3 > least_faces) {
    const std::size_t before = corners.size();
    simplify(positions, corners, before / 6);
    if (static_cast<double>(corners.size()) > kHardlyFewer * static_cast<double>(before)) break;
    levels.push_back(corners.size() / 3);
  }
  return levels;
}

}  // namespace curvecast::cli::bench
