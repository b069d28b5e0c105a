#include "client/bench/discrepancy_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "client/bench/peers/ring_test.h"
#include "client/bench/peers/samplings.h"
#include "core/density/face_density.h"
#include "core/measure/ball_discrepancy.h"
#include "core/measure/coverage.h"
#include "core/measure/spacing.h"

namespace curvecast::cli::bench {
namespace {

struct Spread {
  double ball, rho, coverage;
};

Spread spread_of(const TriangleMesh& mesh, double area, const BallDiscrepancy& balls, const Box3d& box, const PointSet& points) {
  std::vector<Vec3d> positions;
  for (const Vec3f& p : points.positions) positions.emplace_back(points.origin + p.cast<double>());
  const PointCloud cloud(positions, box);
  return {balls.of(positions).rms_relative, neighbour_distances_on_side(area, cloud, points.normals).min,
          coverage_radius(mesh, cloud) / packing_radius(area, points.size())};
}

/// Powers of four and others between, up to the largest.
std::vector<std::uint64_t> sizes_upto(std::uint64_t most) {
  std::vector<std::uint64_t> sizes;
  for (std::uint64_t n = 1024; n <= most; n *= 4) {
    for (const std::uint64_t size : {n, n * 11 / 8, n * 2, n * 23 / 8}) {
      if (size <= most) sizes.push_back(size);
    }
  }
  return sizes;
}

absl::Status measure_spread(const MeshFile& file, const DiscrepancyBenchOptions& options, const ExecutionContext& context,
                            BenchReport& report) {
  const absl::StatusOr<Preprocessed> made =
      preprocess(file, {.points = options.points, .chart_faces = options.chart_faces}, context);
  if (!made.ok()) return made.status();
  const TriangleMesh& mesh = made->flattened->loaded.mesh;
  const double area = made->curve->total_area;
  const BallDiscrepancy balls(mesh, {.seed = options.seed}, {}, context);
  Sampler sampler(*made, {}, options.points, options.seed);
  const std::vector<std::uint64_t> sizes = sizes_upto(options.points);
  for (const Sampling& sampling : kSamplings) {
    Spread worst{0, 1, 0};
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      context.progress(sampling.name, static_cast<double>(i) / static_cast<double>(sizes.size()));
      if (absl::Status status = context.check(); !status.ok()) return status;
      const std::uint64_t n = sizes[i];
      const absl::StatusOr<SampleSet> set = sampler.sample(sampling, n, context);
      if (!set.ok()) return set.status();
      const Spread spread = spread_of(mesh, area, balls, made->curve->box, set->points);
      // Of the shape c N^(-1/4), which a power of N^(-3/4) is beside random points' N^(-1/2).
      worst.ball = std::max(worst.ball, spread.ball * std::pow(static_cast<double>(n), 0.25));
      worst.rho = std::min(worst.rho, spread.rho);
      worst.coverage = std::max(worst.coverage, spread.coverage);
      if (!std::has_single_bit(n) || std::countr_zero(n) % 2 != 0) continue;
      const std::string name = absl::StrFormat("%s, N = %d: ", sampling.name, n);
      report.results.push_back({name + "ball discrepancy, RMS", spread.ball, "of random"});
      report.results.push_back({name + "rho", spread.rho, "of hexagonal"});
      report.results.push_back({name + "coverage radius", spread.coverage, "packing radii"});
    }
    const std::string name = absl::StrFormat("%s, worst of %d N: ", sampling.name, sizes.size());
    report.results.push_back({name + "ball discrepancy N^(1/4)", worst.ball, "of random"});
    report.results.push_back({name + "rho", worst.rho, "of hexagonal"});
    report.results.push_back({name + "coverage radius", worst.coverage, "packing radii"});
  }
  return absl::OkStatus();
}

Density ring_density(const DiscrepancyBenchOptions& options) {
  Density density;
  if (options.curvature) density.terms.emplace_back(CurvatureTerm{});
  if (!options.formula.empty()) density.terms.emplace_back(ExpressionTerm{options.formula});
  return density;
}

/// Farthest points and elimination would take minutes for so many.
bool is_for_rings(Sampling::Kind kind, const Density& density) {
  if (kind == Sampling::kFarthest || kind == Sampling::kElimination) return false;
  return density.terms.empty() || follows_density(kind);
}

absl::Status measure_rings(const MeshFile& file, const DiscrepancyBenchOptions& options, const ExecutionContext& context,
                           BenchReport& report) {
  const absl::StatusOr<Preprocessed> made = preprocess(file, {.points = options.ring_points}, context);
  if (!made.ok()) return made.status();
  const FlattenedMesh& flattened = *made->flattened;
  const TriangleMesh& mesh = flattened.loaded.mesh;
  const Density density = ring_density(options);
  std::vector<double> face_density;
  if (!density.terms.empty()) {
    const auto on_faces = density_on_faces(mesh, flattened.geometry, flattened.loaded.attributes.scalars, density);
    if (!on_faces.ok()) return on_faces.status();
    face_density.assign(on_faces->begin(), on_faces->end());
  }
  const std::vector<double> sizes = ring_set_sizes(options.ring_points);
  Sampler sampler(*made, density, static_cast<std::uint64_t>(sizes.back()), options.seed);
  for (const Sampling& sampling : kSamplings) {
    if (!is_for_rings(sampling.kind, density)) continue;
    const absl::StatusOr<RingTest> test =
        ring_test(sampler, sampling, sizes, {.seed = options.seed, .face_density = face_density}, context);
    if (!test.ok()) return test.status();
    const std::string name = absl::StrFormat("%s, rings of %d sets up to %.0f: ", sampling.name, sizes.size(), sizes.back());
    report.results.push_back({name + "gradient of the RMS", test->rms_gradient, "powers of N"});
    report.results.push_back({name + "gradient of the maximum", test->max_gradient, "powers of N"});
    report.results.push_back({name + "RMS of the largest", test->rms.back(), "of the whole"});
  }
  report.results.push_back({"curve of the rings", static_cast<double>(made->curve->size()), "vertices"});
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<BenchReport> bench_discrepancy(const MeshFile& file, const DiscrepancyBenchOptions& options,
                                              const ExecutionContext& context) {
  BenchReport report{"discrepancy", {}};
  if (absl::Status status = measure_spread(file, options, context, report); !status.ok()) return status;
  if (options.ring_points > 0) {
    if (absl::Status status = measure_rings(file, options, context, report); !status.ok()) return status;
  }
  report.notes = {absl::StrFormat(
      "%s: uniform sets on a curve for %d points; ball discrepancy over what random points have, rho among points on the same "
      "side of "
      "the surface%s.",
      file.name, options.points,
      ring_density(options).terms.empty() ? "" : "; rings with another density, and weighted with it")};
  return report;
}

}  // namespace curvecast::cli::bench
