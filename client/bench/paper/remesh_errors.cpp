#include "client/bench/paper/remesh_errors.h"

#include <algorithm>
#include <cmath>

#include "client/bench/paper/ways.h"
#include "core/measure/hausdorff.h"
#include "core/mesh/pair_halfedges.h"

namespace curvecast::cli::bench {
namespace {

/// A row of the table for each percentage.
struct RemeshWay {
  const char* name;
  Way session;
  const char* density;
  const char* sampler;
  v1::RemeshMethod method = v1::REMESH_METHOD_SURFACE;
  bool fit = false;
};
constexpr RemeshWay kRemeshWays[] = {
    // Strictly |Gaussian curvature|, triangulated in the parameter square.
    {"literal", kLiteral, "curvature:kind=gauss,floor=0", "equalised", v1::REMESH_METHOD_PARAMETER},
    {"defaults", kDefaults, "curvature:kind=max,exponent=0.5", "progressive"},  // what `curvecast remesh` does
    {"fitted", kDefaults, "curvature:kind=max", "progressive", v1::REMESH_METHOD_SURFACE,
     true}};  // --density curvature:kind=max --fit

RemeshError error_between(const TriangleMesh& original, const TriangleMesh& remeshed, std::uint64_t samples,
                          const ExecutionContext& context) {
  const HausdorffDistance distance = hausdorff_distance(original, remeshed, {.samples = samples}, context);
  const double percent = 100 / bounding_box(original).diagonal();
  RemeshError error;
  error.triangles = remeshed.face_count();
  error.mean = percent * distance.larger(&SurfaceDistance::mean);
  error.rms = percent * distance.larger(&SurfaceDistance::rms);
  error.max = percent * distance.max();
  return error;
}

}  // namespace

TriangleMesh to_triangle_mesh(const client::Mesh& mesh) {
  TriangleMesh out;
  const Vec3d origin(mesh.vertices.origin.data());
  for (const auto& [x, y, z] : mesh.vertices.positions) out.positions.emplace_back(origin + Vec3d(x, y, z));
  out.triangles = mesh.triangles;
  out.twins = pair_halfedges(out.triangles, out.positions.size()).twins;
  return out;
}

absl::StatusOr<std::vector<RemeshError>> measure_remesh_errors(const HostedMesh& hosted, const TriangleMesh& original,
                                                               std::span<const int> percentages, std::uint64_t samples,
                                                               const ExecutionContext& context) {
  std::vector<RemeshError> errors;
  double done = 0;
  const double steps = static_cast<double>(std::size(kRemeshWays) * percentages.size());
  for (const RemeshWay& way : kRemeshWays) {
    for (const int percent : percentages) {
      context.progress("remesh", done++ / steps);
      SampleFlags flags;
      flags.points = static_cast<std::uint64_t>(std::lround(0.005 * percent * static_cast<double>(original.face_count())));
      flags.density = {way.density};
      flags.sampler = way.sampler;
      v1::RemeshRequest how;
      how.set_method(way.method);
      how.set_fit(way.fit);
      const absl::StatusOr<client::Mesh> mesh = hosted.remesh(session_flags(way.session), flags, how);
      // The paper's method cannot stitch every cut.
      if (absl::IsInvalidArgument(mesh.status()) && way.method == v1::REMESH_METHOD_PARAMETER) continue;
      if (!mesh.ok()) return mesh.status();
      RemeshError& error = errors.emplace_back(error_between(original, to_triangle_mesh(*mesh), samples, context));
      error.way = way.name;
      error.percent = percent;
      if (absl::Status status = context.check(); !status.ok()) return status;
    }
  }
  return errors;
}

}  // namespace curvecast::cli::bench
