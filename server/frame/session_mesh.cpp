#include "server/frame/session_mesh.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <utility>

#include "core/curve/place_attributes.h"
#include "core/mesh/surface_mesh.h"
#include "core/sample/spread_in_leaves.h"

namespace curvecast::server {
namespace {

constexpr float kOverlap = 0.6f;  // of the longest edge at a vertex: discs of this radius leave no holes

absl::StatusOr<std::vector<FacePlace>> sample_places(const Session& session, const PointSetRequest& request, ViewCache& cache,
                                                     const ExecutionContext& context) {
  absl::StatusOr<Sampled> sampled = sample_points(session, request, cache, context);
  if (!sampled.ok()) return sampled.status();
  PointSet& points = sampled->points();
  if (points.places.empty()) find_places(*sampled->curve, points);
  if (const std::uint64_t wanted = sampled->statistics.wanted_points; points.size() < wanted) {
    return absl::FailedPreconditionError(
        absl::StrCat("the density has places for ", points.size(), " vertices; ", wanted, " were asked for"));
  }
  return std::move(points.places);
}

/// All that is known of the vertices besides their places.
void describe(const CurveBase& base, const Vec3d& origin, const TriangleMesh& mesh, PointSet& out) {
  const std::size_t n = mesh.vertex_count();
  out.origin = origin;
  out.radii.assign(n, 0);
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto length = static_cast<float>((mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).norm());
      for (const std::uint32_t v : {t[i], t[(i + 1) % 3]}) out.radii[v] = std::max(out.radii[v], kOverlap * length);
    }
  }
  for (std::size_t v = 0; v < n; ++v) {
    const auto& [face, weight_1, weight_2] = out.places[v];
    const Vec3f weights(1 - weight_1 - weight_2, weight_1, weight_2);
    const Triangle& corners = base.data.mesh.triangles[face];
    Vec3f normal = Vec3f::Zero();
    for (int i = 0; i < 3; ++i) normal += weights[i] * base.data.geometry[corners[i]].normal;
    const float length = normal.norm();
    out.positions.emplace_back((mesh.positions[v] - origin).cast<float>());
    out.normals.push_back(length > 0 ? Vec3f(normal / length) : Vec3f::UnitZ());
    if (base.data.colour == nullptr) continue;
    const auto radius = static_cast<double>(out.radii[v]);
    out.colours.push_back(base.data.colour->at(face, weights, radius * radius));
  }
}

std::vector<ScalarAttribute> scalars_at(const CurveBase& base, const SurfaceCurve& curve, const std::vector<FacePlace>& places) {
  std::vector<ScalarAttribute> scalars;
  for (std::size_t s = 0; s < curve.scalars.size(); ++s) {
    ScalarAttribute& scalar = scalars.emplace_back();
    scalar.name = curve.scalars[s].name;
    scalar.values.reserve(places.size());
    for (const auto& [face, weight_1, weight_2] : places) {
      scalar.values.push_back(scalar_at(base.data, s, face, {weight_1, weight_2}));
    }
  }
  return scalars;
}

}  // namespace

absl::StatusOr<SessionMesh> make_session_mesh(const Session& session, PointSetRequest request, const RemeshOptions& options,
                                              ViewCache& cache, const ExecutionContext& context) {
  request.attributes = {.surface = true};
  const absl::StatusOr<std::vector<FacePlace>> places = sample_places(session, request, cache, context);
  if (!places.ok()) return places.status();
  const absl::StatusOr<std::shared_ptr<const CurveBase>> base = session.surface->base(context);
  if (!base.ok()) return base.status();
  if (!(*base)->is_all_sound()) return (*base)->status();
  const absl::StatusOr<TriangleMesh> surface = surface_mesh((*base)->data.mesh, (*base)->data.borders, context);
  if (!surface.ok()) return surface.status();
  const std::vector<ChartView> charts((*base)->charts.begin(), (*base)->charts.end());
  absl::StatusOr<Remeshed> made = remesh(*surface, *places, options, context, charts);
  if (!made.ok()) return made.status();
  SessionMesh out;
  out.topology = analyse_topology(made->mesh, context);
  out.topology.component_of_face = {};
  out.angles = least_angles(made->mesh);
  out.vertices.places = std::move(made->places);
  describe(**base, session.curve()->origin, made->mesh, out.vertices);
  out.scalars = scalars_at(**base, *session.curve(), out.vertices.places);
  out.triangles = std::move(made->mesh.triangles);
  return out;
}

}  // namespace curvecast::server
