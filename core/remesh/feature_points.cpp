#include "core/remesh/feature_points.h"

#include <algorithm>

#include "core/remesh/surface_lines.h"
#include "core/sample/sequence.h"

namespace curvecast {
namespace {

/// The place on the halfedge's face at a fraction of its length.
FacePlace place_on(std::uint32_t halfedge, double fraction) {
  double weights[3] = {0, 0, 0};
  weights[halfedge % 3] = 1 - fraction;
  weights[(halfedge + 1) % 3] = fraction;
  return {halfedge / 3, static_cast<float>(weights[1]), static_cast<float>(weights[2])};
}

}  // namespace

FeaturePoints sample_features(const TriangleMesh& mesh, double degrees, std::size_t n, std::uint64_t seed,
                              const ExecutionContext& context) {
  std::vector<std::uint32_t> edges;
  std::vector<double> begin;  // lengths before each edge
  FeaturePoints out;
  for (const SurfaceLine& line : surface_lines(mesh, sharp_edges(mesh, degrees, context), context)) {
    if (line.is_border) continue;
    for (const std::uint32_t h : line.halfedges) {
      edges.push_back(h);
      begin.push_back(out.length);
      out.length += (mesh.positions[mesh.to(h)] - mesh.positions[mesh.from(h)]).norm();
    }
  }
  if (!(out.length > 0)) return out;
  std::vector<double> q(n);
  fill_sequence(Sequence::kJittered, seed, q);
  const auto normal = [&mesh](std::uint32_t h) { return Vec3f(area_vector(mesh, h / 3).normalized().cast<float>()); };
  std::size_t e = 0;
  for (const double fraction : q) {
    const double at = fraction * out.length;
    while (e + 1 < edges.size() && begin[e + 1] <= at) ++e;
    const std::uint32_t h = edges[e];
    const Vec3d &from = mesh.positions[mesh.from(h)], &to = mesh.positions[mesh.to(h)];
    const double t = std::min((at - begin[e]) / (to - from).norm(), 1.0);
    out.places.push_back(place_on(h, t));
    out.positions.push_back(from + t * (to - from));
    out.normals.push_back({normal(h), normal(mesh.twins[h])});
  }
  return out;
}

}  // namespace curvecast
