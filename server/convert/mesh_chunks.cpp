#include "server/convert/mesh_chunks.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "server/convert/convert_points.h"
#include "server/convert/field_validator.h"
#include "server/convert/little_endian.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kChunkMeshBytes = 960 << 10;             // of one message, about: with what holds them, under 1 MiB
constexpr std::size_t kVertexBytes = 12 + 12 + 4 + 3 + 4 + 8;  // position, normal, radius, colour, face, weights
constexpr std::size_t kChunkMeshTriangles = kChunkMeshBytes / sizeof(Triangle);

RemeshMethod to_remesh_method(FieldValidator& check, v1::RemeshMethod method) {
  switch (method) {
    case v1::REMESH_METHOD_UNSPECIFIED:
    case v1::REMESH_METHOD_SURFACE:
      return RemeshMethod::kSurface;
    case v1::REMESH_METHOD_PARAMETER:
      return RemeshMethod::kParameter;
    default:
      check.fail("method", absl::StrFormat("is %d; there is no such method", static_cast<int>(method)));
  }
  return RemeshMethod::kSurface;
}

}  // namespace

absl::StatusOr<RemeshOptions> to_remesh_options(const v1::RemeshRequest& request) {
  FieldValidator check;
  RemeshOptions options;
  if (request.has_relaxations()) {
    options.relaxations =
        static_cast<int>(check.in_range("relaxations", request.relaxations(), std::uint32_t{0}, std::uint32_t{kMaxRelaxations}));
  }
  options.fit = request.fit();
  options.feature_degrees = check.in_range("feature_degrees", request.feature_degrees(), 0.0, 180.0);
  options.method = to_remesh_method(check, request.method());
  if (options.method == RemeshMethod::kParameter && options.feature_degrees > 0) {
    check.fail("feature_degrees",
               absl::StrFormat("is %g; the parameter square's method keeps no features", options.feature_degrees));
  }
  if (!check.ok()) return check.status();
  return options;
}

absl::Status make_mesh_chunks(const SessionMesh& mesh, const SurfaceCurve& curve,
                              const std::function<bool(v1::RemeshResponse)>& emit) {
  const auto& [vertices, scalars, triangles, topology, angles] = mesh;
  absl::Status gone = absl::CancelledError("the client has gone");
  v1::RemeshResponse first;
  v1::RemeshInfo& info = *first.mutable_info();
  info.set_vertices(vertices.size());
  info.set_triangles(triangles.size());
  info.set_components(topology.components);
  info.set_genus(topology.genus);
  info.set_boundary_loops(topology.boundary_loops);
  v1::LeastAngles& least = *info.mutable_angles();
  least.set_median(angles.median);
  least.set_percentile_1(angles.percentile_1);
  least.set_least(angles.least);
  least.set_below_20(angles.below_20);
  if (!emit(std::move(first))) return gone;
  const std::size_t most = kChunkMeshBytes / (kVertexBytes + sizeof(float) * scalars.size());
  for (std::size_t begin = 0; begin < vertices.size(); begin += most) {
    const std::size_t count = std::min(most, vertices.size() - begin);
    absl::StatusOr<v1::PointBlock> block = to_proto(vertices, begin, count, curve.box, std::nullopt);
    if (!block.ok()) return block.status();
    *block->mutable_attributes() = to_proto(vertices, begin, count, curve, nullptr, PointAttributes{.surface = true});
    for (const ScalarAttribute& scalar : scalars) {
      v1::ScalarValues& values = *block->mutable_attributes()->add_scalars();
      values.set_name(scalar.name);
      values.set_values(little_endian(scalar.values, begin, count));
    }
    v1::RemeshResponse response;
    *response.mutable_chunk()->mutable_vertices() = *std::move(block);
    if (!emit(std::move(response))) return gone;
  }
  for (std::size_t begin = 0; begin < triangles.size(); begin += kChunkMeshTriangles) {
    v1::RemeshResponse response;
    response.mutable_chunk()->set_triangles(
        little_endian(triangles, begin, std::min(kChunkMeshTriangles, triangles.size() - begin)));
    if (!emit(std::move(response))) return gone;
  }
  return absl::OkStatus();
}

}  // namespace curvecast::server
