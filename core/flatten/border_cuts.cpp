#include "core/flatten/border_cuts.h"

#include <algorithm>
#include <limits>

#include "core/mesh/triangle_distance.h"

namespace curvecast {
namespace {

/// The halfedge of face f on which both points lie. They are its ends, or its end and its middle where it was split; of the three
/// the nearest one is meant.
std::uint32_t halfedge_under(const TriangleMesh& mesh, std::uint32_t f, const Vec3d& a, const Vec3d& b) {
  std::uint32_t nearest = 3 * f;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
    const Vec3d &from = mesh.positions[mesh.from(h)], &to = mesh.positions[mesh.to(h)];
    const double distance = std::max(triangle_distance(a, from, to, to), triangle_distance(b, from, to, to));
    if (distance < least) {
      least = distance;
      nearest = h;
    }
  }
  return nearest;
}

}  // namespace

std::vector<bool> border_cuts(const TriangleMesh& mesh, const DiscMesh& disc) {
  std::vector<std::uint32_t> place(disc.vertex_count(), kNone);  // on the border
  const std::size_t n = disc.border.size();
  if (n == 0) return {};
  for (std::size_t i = 0; i < n; ++i) place[disc.border[i]] = static_cast<std::uint32_t>(i);
  std::vector<bool> is_cut(n, false);
  for (std::size_t t = 0; t < disc.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = disc.triangles[t][i], b = disc.triangles[t][(i + 1) % 3];
      if (place[a] == kNone || place[b] != (place[a] + 1) % n) continue;
      const std::uint32_t h = halfedge_under(mesh, disc.face_of[t], disc.positions[a], disc.positions[b]);
      is_cut[place[a]] = mesh.twins[h] != kNone;
    }
  }
  return is_cut;
}

}  // namespace curvecast
