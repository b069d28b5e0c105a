#include "client/bench/peers/peer_mesh.h"

#include <utility>

#include "core/mesh/repair.h"

namespace curvecast::cli::bench {

absl::StatusOr<PeerMesh> make_peer_mesh(std::vector<Vec3d> positions, const std::vector<Triangle>& triangles, double seconds) {
  PolygonSoup soup;
  soup.positions = std::move(positions);
  soup.polygon_begin.push_back(0);
  for (const Triangle& t : triangles) {
    soup.indices.insert(soup.indices.end(), t.begin(), t.end());
    soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
  }
  absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup));
  if (!repaired.ok()) return repaired.status();
  const RepairReport& report = repaired->report;
  return PeerMesh{std::move(repaired->mesh), report.nonmanifold_edges + report.split_vertices, seconds};
}

}  // namespace curvecast::cli::bench
