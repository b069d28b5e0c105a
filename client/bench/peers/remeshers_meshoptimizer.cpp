#include <cstdint>

#include "client/bench/peers/meshoptimizer.h"
#include "client/bench/peers/peer_mesh.h"
#include "client/bench/peers/remeshers.h"
#include "core/base/stopwatch.h"

namespace curvecast::cli::bench {

absl::StatusOr<PeerMesh> simplify_meshoptimizer(const TriangleMesh& mesh, std::size_t n) {
  std::vector<Vec3f> positions;
  positions.reserve(mesh.vertex_count());
  const Vec3d origin = mesh.positions.front();  // floats are fine about it
  for (const Vec3d& p : mesh.positions) positions.emplace_back((p - origin).cast<float>());
  std::vector<std::uint32_t> corners = corners_of(mesh);
  Stopwatch watch;
  simplify(positions, corners, 2 * n);
  const double seconds = watch.lap();
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return make_peer_mesh(mesh.positions, triangles, seconds);
}

}  // namespace curvecast::cli::bench
