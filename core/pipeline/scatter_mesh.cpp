#include "core/pipeline/scatter_mesh.h"

#include <absl/strings/str_format.h>

#include <array>
#include <span>

#include "core/base/capacity.h"
#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/with_threads.h"
#include "core/curve/place_attributes.h"
#include "core/curve/surface_colour.h"
#include "core/density/face_density.h"
#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"
#include "core/sample/nested_order.h"
#include "core/sample/point_budget.h"
#include "core/sample/resample.h"
#include "core/sample/scatter.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;
// Of a vertex: its geometry, fans and mean of curvatures; of a corner: where creases are, or its own normal.
constexpr std::uint64_t kBytesPerVertex = 96, kBytesPerFace = 48;

/// A repaired mesh, and what is known of it.
struct KnownMesh {
  KnownMesh(const LoadedMesh& loaded_mesh, bool with_curvatures, std::optional<double> degrees, const ExecutionContext& context)
      : loaded(loaded_mesh) {
    const TriangleMesh& mesh = loaded.mesh;
    const VertexFans fans(mesh, context);
    geometry = with_curvatures ? differential_geometry(mesh, fans, context) : vertex_normals(mesh, fans, context);
    creases = crease_normals(mesh, crease_degrees({.crease_degrees = degrees}, loaded.info.crease_degrees), fans, context);
    if (has_colour(loaded.attributes)) colour.emplace(mesh, loaded.attributes);
    data = SurfaceData(mesh, geometry, creases, loaded.attributes, colour ? &*colour : nullptr);
  }
  KnownMesh(const KnownMesh&) = delete;
  KnownMesh& operator=(const KnownMesh&) = delete;

  const LoadedMesh& loaded;
  std::vector<VertexGeometry> geometry;
  CreaseNormals creases;
  std::optional<SurfaceColour> colour;
  SurfaceData data;
};

/// The mesh, which is there already, and what is to be known of it.
absl::Status claim_mesh(const TriangleMesh& mesh, MemoryClaim& claim) {
  const std::uint64_t bytes = capacity_bytes(mesh.positions, mesh.triangles, mesh.twins) + kBytesPerVertex * mesh.vertex_count() +
                              kBytesPerFace * mesh.face_count();
  return claim.set(bytes, absl::StrFormat("to scatter points on %d triangles takes %s of memory", mesh.face_count(),
                                          describe_bytes(static_cast<double>(bytes))));
}

/// A row of `width` numbers for each point.
template <std::size_t width, typename RowOf>
std::vector<float> rows(std::size_t points, const ExecutionContext& context, const RowOf& row_of) {
  std::vector<float> out(width * points);
  for_blocks(context, points, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = row_of(i);
      for (std::size_t k = 0; k < width; ++k) out[width * i + k] = row[static_cast<decltype(Vec3f().size())>(k)];
    }
  });
  return out;
}

ScatteredPoints describe(PointSet points, const KnownMesh& mesh, const MeshScatter& wanted, const ExecutionContext& context) {
  ScatteredPoints out;
  const auto weights_at = [&](std::size_t i) { return std::array{points.places[i].weight_1, points.places[i].weight_2}; };
  if (wanted.curvatures) {
    out.curvatures = rows<2>(points.size(), context,
                             [&](std::size_t i) { return curvatures_at(mesh.data, points.places[i].face, weights_at(i)); });
  }
  if (wanted.directions) {
    out.directions = rows<3>(points.size(), context, [&](std::size_t i) {
      return direction_min_at(mesh.data, points.places[i].face, weights_at(i), points.normals[i]);
    });
  }
  const std::vector<ScalarAttribute>& scalars = mesh.loaded.attributes.scalars;
  for (std::size_t s = 0; wanted.scalars && s < scalars.size(); ++s) {
    out.scalars.emplace_back(scalars[s].name, rows<1>(points.size(), context, [&](std::size_t i) {
                               return std::array{scalar_at(mesh.data, s, points.places[i].face, weights_at(i))};
                             }));
  }
  for (FacePlace& place : points.places) place = place_in_file(place, mesh.loaded.sources);
  out.points = std::move(points);
  return out;
}

absl::StatusOr<ScatteredPoints> scatter_here(const LoadedMesh& loaded, const MeshScatter& wanted,
                                             const ExecutionContext& context) {
  MemoryClaim claim(context);
  if (absl::Status status = claim_mesh(loaded.mesh, claim); !status.ok()) return status;
  const Density& density = wanted.density;
  const bool with_curvatures = !density.terms.empty() || wanted.curvatures || wanted.directions;
  const KnownMesh mesh(loaded, with_curvatures, wanted.crease_degrees, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  DensityAt density_here;
  if (!density.terms.empty()) {
    density_here = [&](std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>> weights) {
      return density_at(mesh.loaded.mesh, mesh.geometry, mesh.loaded.attributes.scalars, density, faces, weights, context);
    };
  }
  const ScatterOptions options{
      .points = scaled_points(density, mesh.loaded.info.box, wanted.points), .seed = wanted.seed, .rounds = wanted.rounds};
  absl::StatusOr<PointSet> points = scatter(mesh.loaded.mesh, mesh.data, density_here, options, context);
  if (!points.ok()) return points.status();
  if (wanted.ranks) {
    absl::StatusOr<std::vector<std::uint32_t>> ranks = nested_order(points->positions, points->radii, wanted.seed, context);
    if (!ranks.ok()) return ranks.status();
    points->ranks = *std::move(ranks);
  }
  ScatteredPoints out = describe(*std::move(points), mesh, wanted, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  return out;
}

}  // namespace

absl::StatusOr<ScatteredPoints> scatter_mesh(const LoadedMesh& mesh, const MeshScatter& wanted, const ExecutionContext& context) {
  if (absl::Status status = check_crease_degrees(wanted.crease_degrees); !status.ok()) return status;
  if (absl::Status status = check_sample(wanted.points, wanted.density); !status.ok()) return status;
  return with_threads(context, [&] { return scatter_here(mesh, wanted, context); });
}

}  // namespace curvecast
