#include "client/bench/remesh_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/bench/peers/remeshers.h"
#include "client/bench/points/progressive_points.h"
#include "core/base/stopwatch.h"
#include "core/measure/hausdorff.h"
#include "core/measure/triangle_angles.h"
#include "core/mesh/topology.h"
#include "core/remesh/remesh.h"

namespace curvecast::cli::bench {
namespace {

struct Way {
  const char* name;
  std::optional<CurvatureTerm> density;  // none: uniform
  RemeshOptions options;
};

const Way kWays[] = {
    {"uniform, triangulated", std::nullopt, {.relaxations = 0}},
    {"uniform", std::nullopt, {}},
    {"root of curvature, triangulated", CurvatureTerm{.kind = CurvatureKind::kMax, .exponent = 0.5}, {.relaxations = 0}},
    {"root of curvature (default)", CurvatureTerm{.kind = CurvatureKind::kMax, .exponent = 0.5}, {}},
    {"curvature", CurvatureTerm{.kind = CurvatureKind::kMax}, {}},
    {"Gaussian curvature (the paper's)", CurvatureTerm{.kind = CurvatureKind::kGauss}, {}},
    {"root of curvature, fitted", CurvatureTerm{.kind = CurvatureKind::kMax, .exponent = 0.5}, {.fit = true}},
    {"curvature, fitted", CurvatureTerm{.kind = CurvatureKind::kMax}, {.fit = true}},
};

struct Peer {
  const char* name;
  absl::StatusOr<PeerMesh> (*make)(const TriangleMesh& mesh, std::size_t n);
};

constexpr Peer kPeers[] = {
    {"CGAL, isotropic", remesh_isotropic_cgal},
    {"CGAL, Garland-Heckbert", collapse_garland_heckbert_cgal},
    {"CGAL, Lindstrom-Turk", collapse_lindstrom_turk_cgal},
    {"meshoptimizer", simplify_meshoptimizer},
};

class RemeshBench {
 public:
  RemeshBench(const TriangleMesh& mesh, const RemeshBenchOptions& options, const ExecutionContext& context)
      : mesh_(mesh), options_(options), context_(context), percent_(bounding_box(mesh).diagonal() / 100) {
    table_.name = "remesh";
    table_.columns = {"vertices",     "way",        "seconds", "sampling",       "max",   "mean",
                      "rms",          "normals",    "median",  "1st percentile", "least", "% below 20",
                      "not manifold", "components", "genus",   "borders"};
  }

  absl::Status add_ours(ProgressivePoints& points, std::uint64_t n) {
    for (const Way& way : kWays) {
      context_.progress(way.name, 0);
      Density density;
      if (way.density) density.terms.emplace_back(*way.density);
      Stopwatch watch;
      const absl::StatusOr<PointSet> made = points.sample(density, n, context_);
      if (!made.ok()) return made.status();
      const double sampling = watch.lap();
      double seconds = std::numeric_limits<double>::infinity();
      std::optional<Remeshed> best;
      for (int i = 0; i < options_.repeats; ++i) {
        watch.lap();
        absl::StatusOr<Remeshed> remeshed = remesh(mesh_, made->places, way.options, context_);
        if (!remeshed.ok()) return remeshed.status();
        seconds = std::min(seconds, watch.lap());
        best = *std::move(remeshed);
      }
      if (absl::Status status = add_row(way.name, best->mesh, 0, seconds, sampling); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status add_peers(std::uint64_t n) {
    for (const Peer& peer : kPeers) {
      if (absl::Status status = context_.check(); !status.ok()) return status;
      context_.progress(peer.name, 0);
      const absl::StatusOr<PeerMesh> made = peer.make(mesh_, static_cast<std::size_t>(n));
      if (!made.ok()) {
        notes_.push_back(absl::StrCat(peer.name, ", ", n, " vertices: ", made.status().message(), "."));
        continue;
      }
      if (absl::Status status = add_row(peer.name, made->mesh, made->broken, made->seconds, 0); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  BenchTable table() && { return std::move(table_); }
  std::vector<std::string> notes() && { return std::move(notes_); }

 private:
  absl::Status add_row(const char* way, const TriangleMesh& mesh, std::size_t broken, double seconds, double sampling) {
    const HausdorffDistance distance = hausdorff_distance(mesh_, mesh, {}, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    const LeastAngles angles = least_angles(mesh);
    const Topology topology = analyse_topology(mesh, context_);
    const auto percent = [&](double SurfaceDistance::*measure) { return rounded(distance.larger(measure) / percent_, 5); };
    table_.rows.push_back({mesh.vertex_count(), way, rounded(seconds, 3), rounded(sampling, 3), percent(&SurfaceDistance::max),
                           percent(&SurfaceDistance::mean), percent(&SurfaceDistance::rms),
                           rounded(distance.larger(&SurfaceDistance::normal_rms), 2), rounded(angles.median, 1),
                           rounded(angles.percentile_1, 1), rounded(angles.least, 2), rounded(100 * angles.below_20, 3), broken,
                           topology.components, topology.genus, topology.boundary_loops});
    return absl::OkStatus();
  }

  static double rounded(double value, int digits) {
    const double unit = std::pow(10.0, digits);
    return std::round(value * unit) / unit;
  }

  const TriangleMesh& mesh_;
  const RemeshBenchOptions& options_;
  const ExecutionContext& context_;
  const double percent_;  // of the diagonal
  BenchTable table_;
  std::vector<std::string> notes_;
};

}  // namespace

absl::StatusOr<BenchReport> bench_remesh(const MeshFile& file, const RemeshBenchOptions& options,
                                         const ExecutionContext& context) {
  const absl::StatusOr<Preprocessed> made = preprocess(file, {}, context);
  if (!made.ok()) return made.status();
  const TriangleMesh& mesh = made->flattened->loaded.mesh;
  const auto own = static_cast<std::uint64_t>(mesh.vertex_count());
  std::vector<std::uint64_t> counts = {options.vertices};
  if (options.vertices == 0) counts = {own * 3 / 4, own / 2, own / 4};
  if (counts.back() < 10)
    return absl::InvalidArgumentError(absl::StrCat("meshes of ", counts.back(), " vertices cannot be compared"));
  absl::StatusOr<ProgressivePoints> points = ProgressivePoints::make(*made, counts.front(), options.seed, context);
  if (!points.ok()) return points.status();
  RemeshBench bench(mesh, options, context);
  for (const std::uint64_t n : counts) {
    if (absl::Status status = bench.add_ours(*points, n); !status.ok()) return status;
    if (!options.peers) continue;
    if (absl::Status status = bench.add_peers(n); !status.ok()) return status;
  }
  BenchReport report{"remesh", {}};
  report.tables.push_back(std::move(bench).table());
  report.notes = std::move(bench).notes();
  report.notes.push_back(absl::StrFormat(
      "%s: %d vertices, %d faces. Distances in %% of the box's diagonal, mean and RMS the larger of both ways, the "
      "maximum that of both; normals: RMS of the angle between them; angles: the smallest of each triangle, in "
      "degrees. Ours: the fastest of %d runs, sampling beside it; others one run of their own work alone.",
      file.name, mesh.vertex_count(), mesh.face_count(), options.repeats));
  return report;
}

}  // namespace curvecast::cli::bench
