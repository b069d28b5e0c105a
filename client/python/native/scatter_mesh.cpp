#include "client/python/native/scatter_mesh.h"

#include <absl/strings/str_format.h>
#include <tbb/task_arena.h>

#include <array>
#include <span>

#include "core/base/for_all.h"
#include "core/curve/place_attributes.h"
#include "core/curve/surface_colour.h"
#include "core/density/face_density.h"
#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/scatter.h"
#include "server/convert/convert.h"

namespace curvecast::python {
namespace {

constexpr std::size_t kGrain = 4096;

/// A repaired mesh, and what is known of it.
struct KnownMesh {
  KnownMesh(LoadedMesh loaded_mesh, bool with_curvatures, std::optional<double> crease_degrees, const ExecutionContext& context)
      : loaded(std::move(loaded_mesh)) {
    const TriangleMesh& mesh = loaded.mesh;
    const VertexFans fans(mesh, context);
    geometry = with_curvatures ? differential_geometry(mesh, fans, context) : vertex_normals(mesh, fans, context);
    const PreprocessOptions options{.crease_degrees = crease_degrees};
    creases = crease_normals(mesh, curvecast::crease_degrees(options, loaded.info.crease_degrees), fans, context);
    if (has_colour(loaded.attributes)) colour.emplace(mesh, loaded.attributes);
    data = SurfaceData(mesh, geometry, creases, loaded.attributes, colour ? &*colour : nullptr);
  }
  KnownMesh(const KnownMesh&) = delete;
  KnownMesh& operator=(const KnownMesh&) = delete;

  const LoadedMesh loaded;
  std::vector<VertexGeometry> geometry;
  CreaseNormals creases;
  std::optional<SurfaceColour> colour;
  SurfaceData data;
};

absl::Status check(const v1::SampleRequest& request, const server::PointSetRequest& wanted,
                   std::optional<double> crease_degrees) {
  if (crease_degrees && !(*crease_degrees >= 0 && *crease_degrees <= 180)) {
    return absl::InvalidArgumentError(absl::StrFormat("crease_degrees = %g; it must lie in 0 .. 180", *crease_degrees));
  }
  if (wanted.pixel_error > 0 || wanted.max_bytes > 0 || wanted.automatic) {
    return absl::InvalidArgumentError("points are scattered by their number, not within a budget");
  }
  if (request.sampler() == v1::SAMPLER_PROGRESSIVE) {
    return absl::InvalidArgumentError("points that are scattered have no ranks: take those of a surface");
  }
  if (wanted.options.sequence != Sequence::kJittered) {
    return absl::InvalidArgumentError("points are scattered at equal steps along the curve, by no other sequence");
  }
  return absl::OkStatus();
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

ScatteredPoints describe(PointSet points, const KnownMesh& mesh, const server::PointAttributes& wanted,
                         const ExecutionContext& context) {
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

absl::StatusOr<ScatteredPoints> scatter_here(LoadedMesh loaded, const server::PointSetRequest& wanted,
                                             std::optional<double> crease_degrees, const ExecutionContext& context) {
  const Density& density = wanted.options.density;
  const bool with_curvatures = !density.terms.empty() || wanted.attributes.curvatures || wanted.attributes.directions;
  const KnownMesh mesh(std::move(loaded), with_curvatures, crease_degrees, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  DensityAt density_here;
  if (!density.terms.empty()) {
    density_here = [&](std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>> weights) {
      return density_at(mesh.loaded.mesh, mesh.geometry, mesh.loaded.attributes.scalars, density, faces, weights, context);
    };
  }
  absl::StatusOr<PointSet> points =
      scatter(mesh.loaded.mesh, mesh.data, density_here,
              {.points = wanted.options.points, .seed = wanted.options.seed, .rounds = wanted.relaxation_rounds}, context);
  if (!points.ok()) return points.status();
  ScatteredPoints out = describe(*std::move(points), mesh, wanted.attributes, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  return out;
}

}  // namespace

absl::StatusOr<ScatteredPoints> scatter_mesh(PolygonSoup soup, const std::string& name, const v1::SampleRequest& request,
                                             std::optional<double> crease_degrees, const ExecutionContext& context) {
  const absl::StatusOr<server::PointSetRequest> wanted = server::to_point_set_request(request);
  if (!wanted.ok()) return wanted.status();
  if (absl::Status status = check(request, *wanted, crease_degrees); !status.ok()) return status;
  absl::StatusOr<LoadedMesh> loaded = load_mesh(std::move(soup), name, context);
  if (!loaded.ok()) return loaded.status();
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return scatter_here(*std::move(loaded), *wanted, crease_degrees, context); });
}

}  // namespace curvecast::python
