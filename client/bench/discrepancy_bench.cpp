#include "client/bench/discrepancy_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/bench/peers/farthest_points.h"
#include "core/density/face_density.h"
#include "core/measure/ball_discrepancy.h"
#include "core/measure/coverage.h"
#include "core/measure/gradient.h"
#include "core/measure/ring_discrepancy.h"
#include "core/measure/spacing.h"
#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/sample_ranked.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

struct Sampling {
  enum Kind { kEqualised, kProgressive, kFarthest };

  const char* name;
  Kind kind;
  Sequence sequence = Sequence::kJittered;
};
constexpr Sampling kSamplings[] = {{"equalised jittered", Sampling::kEqualised, Sequence::kJittered},
                                   {"equalised regular", Sampling::kEqualised, Sequence::kRegular},
                                   {"equalised vandercorput", Sampling::kEqualised, Sequence::kVanDerCorput},
                                   {"equalised golden", Sampling::kEqualised, Sequence::kGoldenRatio},
                                   {"progressive", Sampling::kProgressive},
                                   {"farthest point", Sampling::kFarthest}};
constexpr std::uint64_t kFarthestCandidates = 262'144;

/// Sets of points of all samplings on one curve.
class Sampler {
 public:
  Sampler(const Preprocessed& made, Density density, std::uint64_t seed)
      : surface_(leaf_surface(made)), curve_(made.curve), density_(std::move(density)), seed_(seed) {}

  absl::Status prepare(std::uint64_t most_points, const ExecutionContext& context) {
    auto fixed = make_fixed_density(*curve_, density_.terms);
    if (!fixed.ok()) return fixed.status();
    fixed_ = *std::move(fixed);
    const int level = std::clamp((static_cast<int>(std::bit_width(most_points - 1)) + 1) / 2, kChunkLevels, kMaxLevelAtOnce);
    ExecutionContext quiet = context;
    quiet.on_progress = nullptr;
    auto grower = RankGrower::make(surface_, {.level = level}, quiet);
    if (!grower.ok()) return grower.status();
    grower_ = *std::move(grower);
    most_points_ = most_points;
    return absl::OkStatus();
  }

  absl::StatusOr<PointSet> sample(const Sampling& sampling, std::uint64_t n, const ExecutionContext& context) {
    if (sampling.kind == Sampling::kEqualised) {
      const ResampleOptions options{.points = n, .density = density_, .sequence = sampling.sequence, .seed = seed_};
      return resample(*curve_, options);
    }
    if (sampling.kind == Sampling::kFarthest) return farthest(n);
    RankedWorkspace workspace;
    while (true) {
      absl::Status status = sample_ranked(*curve_, grower_->tree(), fixed_.get(), density_, n, workspace);
      if (!status.ok()) return status;
      if (workspace.selection.lacking.empty()) return std::move(workspace.points);
      ExecutionContext quiet = context;
      quiet.on_progress = nullptr;
      status = grower_->grow(workspace.selection.most_lacking(), 8 * kMaxPoints, quiet);
      if (!status.ok()) return status;
    }
  }

 private:
  /// The first n in farthest-point order of even candidates, four or more for each point of the largest set.
  absl::StatusOr<PointSet> farthest(std::uint64_t n) {
    if (order_.empty()) {
      absl::StatusOr<PointSet> candidates =
          resample(*curve_, {.points = std::max(kFarthestCandidates, std::min(4 * most_points_, kMaxPoints)), .seed = seed_});
      if (!candidates.ok()) return candidates.status();
      candidates_ = *std::move(candidates);
      order_ = farthest_points(candidates_.positions, static_cast<std::size_t>(most_points_));
    }
    PointSet points;
    points.origin = candidates_.origin;
    for (const std::uint32_t i : std::span(order_).first(static_cast<std::size_t>(n))) {
      points.positions.push_back(candidates_.positions[i]);
      points.normals.push_back(candidates_.normals[i]);
    }
    return points;
  }

  std::shared_ptr<const LeafSurface> surface_;
  std::shared_ptr<const SurfaceCurve> curve_;
  Density density_;
  std::uint64_t seed_;
  std::shared_ptr<const FixedDensity> fixed_;
  std::unique_ptr<RankGrower> grower_;
  std::uint64_t most_points_ = 0;
  PointSet candidates_;  // of farthest()
  std::vector<std::uint32_t> order_;
};

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
  Sampler sampler(*made, {}, options.seed);
  if (absl::Status status = sampler.prepare(options.points, context); !status.ok()) return status;
  const std::vector<std::uint64_t> sizes = sizes_upto(options.points);
  for (const Sampling& sampling : kSamplings) {
    Spread worst{0, 1, 0};
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      context.progress(sampling.name, static_cast<double>(i) / static_cast<double>(sizes.size()));
      if (absl::Status status = context.check(); !status.ok()) return status;
      const std::uint64_t n = sizes[i];
      const absl::StatusOr<PointSet> points = sampler.sample(sampling, n, context);
      if (!points.ok()) return points.status();
      const Spread spread = spread_of(mesh, area, balls, made->curve->box, *points);
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

absl::Status measure_rings(const MeshFile& file, const DiscrepancyBenchOptions& options, const ExecutionContext& context,
                           BenchReport& report) {
  const absl::StatusOr<Preprocessed> made = preprocess(file, {.points = options.ring_points}, context);
  if (!made.ok()) return made.status();
  const SurfaceCurve& curve = *made->curve;
  const FlattenedMesh& flattened = *made->flattened;
  const TriangleMesh& mesh = flattened.loaded.mesh;
  const Density density = ring_density(options);
  std::vector<double> face_density;
  if (!density.terms.empty()) {
    const auto on_faces = density_on_faces(mesh, flattened.geometry, flattened.loaded.attributes.scalars, density);
    if (!on_faces.ok()) return on_faces.status();
    face_density.assign(on_faces->begin(), on_faces->end());
  }
  std::vector<double> sizes;
  for (std::uint64_t l = 1; l <= 20; ++l) {
    for (const std::uint64_t n : {std::uint64_t{1} << l, (std::uint64_t{1} << l) + (std::uint64_t{1} << (l - 1))}) {
      if (n <= options.ring_points) sizes.push_back(static_cast<double>(n));
    }
  }
  Sampler sampler(*made, density, options.seed);
  if (absl::Status status = sampler.prepare(static_cast<std::uint64_t>(sizes.back()), context); !status.ok()) return status;
  for (const Sampling& sampling : kSamplings) {
    if (sampling.kind == Sampling::kFarthest) continue;  // it knows no density
    std::vector<std::vector<std::uint32_t>> sets;
    for (const double n : sizes) {
      context.progress(sampling.name, static_cast<double>(sets.size()) / static_cast<double>(sizes.size()));
      if (absl::Status status = context.check(); !status.ok()) return status;
      const absl::StatusOr<PointSet> points = sampler.sample(sampling, static_cast<std::uint64_t>(n), context);
      if (!points.ok()) return points.status();
      std::vector<std::uint32_t>& faces = sets.emplace_back();
      for (const std::uint32_t l : points->vertices) faces.push_back(curve.triangle[l]);
    }
    const std::vector<Discrepancy> rings =
        ring_discrepancy(mesh, sets, {.seed = options.seed, .face_density = face_density}, context);
    if (absl::Status status = context.check(); !status.ok()) return status;
    std::vector<double> rms, most;
    for (const Discrepancy& d : rings) rms.push_back(d.rms), most.push_back(d.max);
    const std::string name = absl::StrFormat("%s, rings of %d sets up to %.0f: ", sampling.name, sizes.size(), sizes.back());
    report.results.push_back({name + "gradient of the RMS", log_log_gradient(sizes, rms), "powers of N"});
    report.results.push_back({name + "gradient of the maximum", log_log_gradient(sizes, most), "powers of N"});
    report.results.push_back({name + "RMS of the largest", rms.back(), "of the whole"});
  }
  report.results.push_back({"curve of the rings", static_cast<double>(curve.size()), "vertices"});
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
