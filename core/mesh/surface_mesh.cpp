#include "core/mesh/surface_mesh.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/mesh/pair_halfedges.h"

namespace curvecast {
namespace {

/// Joins the halfedges inside the surface that have no twin yet; returns how many stay alone.
std::size_t pair_rest(TriangleMesh& mesh, const std::vector<bool>& on_border) {
  std::vector<std::uint32_t> rest;
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone && !on_border[h]) rest.push_back(h);
  }
  const auto ends = [&](std::uint32_t h) { return std::minmax({mesh.from(h), mesh.to(h)}); };
  std::sort(rest.begin(), rest.end(),
            [&](std::uint32_t g, std::uint32_t h) { return std::pair(ends(g), g) < std::pair(ends(h), h); });
  std::size_t alone = 0;
  for (std::size_t i = 0, end = 0; i < rest.size(); i = end) {
    while (end < rest.size() && ends(rest[end]) == ends(rest[i])) ++end;
    if (end - i == 2 && mesh.from(rest[i]) == mesh.to(rest[i + 1])) {
      mesh.twins[rest[i]] = rest[i + 1], mesh.twins[rest[i + 1]] = rest[i];
    } else {
      alone += end - i;
    }
  }
  return alone;
}

}  // namespace

absl::StatusOr<TriangleMesh> surface_mesh(const MeshView& view, std::span<const std::uint32_t> borders,
                                          const ExecutionContext& context) {
  TriangleMesh mesh;
  mesh.positions.assign(view.positions.begin(), view.positions.end());
  mesh.triangles.assign(view.triangles.begin(), view.triangles.end());
  HalfedgePairs pairs = pair_halfedges(mesh.triangles, mesh.vertex_count(), context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  mesh.twins = std::move(pairs.twins);
  std::vector<bool> on_border(mesh.twins.size(), false);
  for (const std::uint32_t h : borders) {
    on_border[h] = true;
    if (mesh.twins[h] == kNone) continue;
    mesh.twins[mesh.twins[h]] = kNone;
    mesh.twins[h] = kNone;
  }
  if (const std::size_t alone = pair_rest(mesh, on_border); alone > 0) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "%d sides of triangles may have several neighbours: where the surface goes on there cannot be told", alone));
  }
  return mesh;
}

}  // namespace curvecast
