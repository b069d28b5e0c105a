#include "client/bench/sample_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/bench/median.h"
#include "client/bench/rank_bench.h"
#include "client/bench/read_bytes.h"
#include "core/base/stopwatch.h"
#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kMilliseconds = 1e3;

/// Seconds to read what a view is made from.
double seconds_to_read(const SurfaceCurve& curve) {
  Stopwatch watch;
  const volatile std::uint64_t kept = read_bytes(curve.x) ^ read_bytes(curve.y) ^ read_bytes(curve.z) ^ read_bytes(curve.nx) ^
                                      read_bytes(curve.ny) ^ read_bytes(curve.nz) ^ read_bytes(curve.area);
  static_cast<void>(kept);
  return watch.lap();
}

/// One kind of point set, made again and again.
class Case {
 public:
  Case(std::string name, ResampleOptions options, bool in_fresh_memory)
      : name_(std::move(name)), options_(std::move(options)), in_fresh_memory_(in_fresh_memory) {}

  absl::Status prepare(const SurfaceCurve& curve) {
    absl::StatusOr<std::shared_ptr<const FixedDensity>> fixed = make_fixed_density(curve, options_.density.terms);
    if (!fixed.ok()) return fixed.status();
    fixed_ = *std::move(fixed);
    return absl::OkStatus();
  }

  absl::Status run(const SurfaceCurve& curve) {
    ResampleReport report;
    Stopwatch watch;
    if (in_fresh_memory_) workspace_ = {};
    absl::Status status = resample(curve, fixed_.get(), options_, workspace_, &report);
    whole_.push_back(watch.lap());
    density_.push_back(report.density_seconds);
    equalise_.push_back(report.equalise_seconds - report.gather_seconds);
    gather_.push_back(report.gather_seconds);
    return status;
  }

  void report(double seconds_to_read, BenchReport& report) const {
    const auto add = [&](const char* stage, const std::vector<double>& seconds) {
      report.results.push_back(
          {absl::StrCat(name_, stage), kMilliseconds * median(seconds), "ms", kMilliseconds * seconds_to_read});
    };
    add("", whole_);
    if (in_fresh_memory_) return;
    add(": density", density_);
    add(": equalise", equalise_);
    add(": gather", gather_);
  }

 private:
  std::string name_;
  ResampleOptions options_;
  bool in_fresh_memory_;
  std::shared_ptr<const FixedDensity> fixed_;
  ResampleWorkspace workspace_;
  std::vector<double> whole_, density_, equalise_, gather_;  // seconds
};

std::vector<Case> cases(const SurfaceCurve& curve, const SampleBenchOptions& options) {
  const DensityTerm view = ViewTerm{};
  const std::vector<Camera> cameras = {orbit_camera(curve, 0)};
  const DensityTerm bends = CurvatureTerm{};
  const auto evenly = absl::StrFormat("N = %d", options.points), viewed = absl::StrFormat("view, N = %d", options.view_points);
  const auto with = [&](std::uint64_t points, std::vector<DensityTerm> terms) {
    return ResampleOptions{.points = points, .density = {std::move(terms), cameras}, .seed = options.seed};
  };
  std::vector<Case> all;
  all.emplace_back(evenly, with(options.points, {}), false);
  all.emplace_back(absl::StrCat(evenly, ", fresh memory"), with(options.points, {}), true);
  all.emplace_back(absl::StrCat("curvature, ", evenly), with(options.points, {bends}), false);
  all.emplace_back(viewed, with(options.view_points, {view}), false);
  all.emplace_back(absl::StrCat(viewed, ", fresh memory"), with(options.view_points, {view}), true);
  all.emplace_back(absl::StrCat("curvature x ", viewed), with(options.view_points, {bends, view}), false);
  return all;
}

}  // namespace

absl::StatusOr<BenchReport> bench_sample(const MeshFile& file, const SampleBenchOptions& options,
                                         const ExecutionContext& context) {
  const absl::StatusOr<Preprocessed> made = preprocess(file, {.points = options.points}, context);
  if (!made.ok()) return made.status();
  const SurfaceCurve& curve = *made->curve;
  std::vector<Case> all = cases(curve, options);
  std::vector<double> read;
  for (Case& one : all) {
    if (absl::Status status = one.prepare(curve); !status.ok()) return status;
  }
  for (int i = 0; i < options.repeats; ++i) {
    context.progress("point sets", static_cast<double>(i) / options.repeats);
    if (absl::Status status = context.check(); !status.ok()) return status;
    read.push_back(seconds_to_read(curve));
    for (Case& one : all) {
      if (absl::Status status = one.run(curve); !status.ok()) return status;
    }
  }
  context.progress("point sets", 1);
  BenchReport report{"sample", {}};
  const double reference = median(read);
  report.results.push_back({"read positions, normals, areas once", kMilliseconds * reference, "ms"});
  for (const Case& one : all) one.report(reference, report);
  if (absl::Status status = bench_ranks(leaf_surface(*made), options, reference, context, report); !status.ok()) return status;
  report.results.push_back({"curve", static_cast<double>(curve.byte_size()) / static_cast<double>(curve.size()), "B/vertex"});
  report.notes = {absl::StrFormat(
      "%s: %d curve vertices of a curve for %d points; medians of %d rounds, in each of which all cases have their turn; one "
      "thread. The reference is the time to read positions, normals and areas of all vertices once. equalise: the sequence and "
      "the inversion; gather: positions, normals, radii. Fixed densities are made before.",
      file.name, curve.size(), options.points, options.repeats)};
  return report;
}

}  // namespace curvecast::cli::bench
