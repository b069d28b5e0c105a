#include <meshoptimizer.h>

#include <cstdint>

#include "client/bench/peers/peer_mesh.h"
#include "client/bench/peers/remeshers.h"
#include "core/base/stopwatch.h"

namespace curvecast::cli::bench {

absl::StatusOr<PeerMesh> simplify_meshoptimizer(const TriangleMesh& mesh, std::size_t n) {
  std::vector<Vec3f> positions;
  positions.reserve(mesh.vertex_count());
  const Vec3d origin = mesh.positions.front();  // floats are fine about it
  for (const Vec3d& p : mesh.positions) positions.emplace_back((p - origin).cast<float>());
  std::vector<std::uint32_t> corners, fewer(3 * mesh.face_count());
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  constexpr float kAnyError = 1e6f;  // of the mesh's extent: it ends by the number of triangles
  Stopwatch watch;
  fewer.resize(meshopt_simplify(fewer.data(), corners.data(), corners.size(), positions.front().data(), positions.size(),
                                sizeof(Vec3f), 6 * n, kAnyError, 0, nullptr));
  const double seconds = watch.lap();
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < fewer.size(); i += 3) triangles.push_back({fewer[i], fewer[i + 1], fewer[i + 2]});
  return make_peer_mesh(mesh.positions, triangles, seconds);
}

}  // namespace curvecast::cli::bench
