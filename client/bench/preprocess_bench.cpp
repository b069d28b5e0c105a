#include "client/bench/preprocess_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <thread>
#include <utility>

#include "client/bench/median.h"
#include "client/bench/stages.h"
#include "core/flatten/parameterise_cgal.h"

namespace curvecast::cli::bench {
namespace {

struct Reference {
  const char* name;
  CgalPreconditioner preconditioner;
};

constexpr std::array<Reference, 2> kReferences = {
    {{"CGAL (incomplete LU)", CgalPreconditioner::kIncompleteLu}, {"CGAL (diagonal)", CgalPreconditioner::kDiagonal}}};

/// CGAL on every disc. Discs that it refuses are counted and cost nothing.
struct CgalRun {
  double seconds = 0;
  std::size_t refused = 0;
  std::uint64_t flipped = 0;
};

CgalRun run_cgal(const std::vector<Chart>& charts, CgalPreconditioner preconditioner) {
  CgalRun run;
  for (const Chart& chart : charts) {
    double seconds = 0;
    const absl::StatusOr<std::vector<Vec2d>> uv = parameterise_cgal(chart.disc, preconditioner, &seconds);
    run.seconds += seconds;
    run.refused += !uv.ok();
    if (uv.ok()) run.flipped += count_flipped(chart.disc, *uv);
  }
  return run;
}

}  // namespace

absl::StatusOr<BenchReport> bench_preprocess(const MeshFile& file, const PreprocessBenchOptions& options,
                                             const ExecutionContext& context) {
  BenchReport report{"preprocess", {}};
  const PreprocessOptions preprocess_options{.points = options.points};
  std::vector<std::pair<std::string, StageSeconds>> ours;
  std::shared_ptr<const FlattenedMesh> flattened;
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  for (const int threads : {1, cores}) {
    if (!ours.empty() && threads == 1) break;
    ExecutionContext run_context = context;
    run_context.threads = threads;
    std::vector<StageSeconds> runs;
    for (int i = 0; i < options.repeats; ++i) {
      const absl::StatusOr<Preprocessed> done = preprocess(file, preprocess_options, run_context);
      if (!done.ok()) return done.status();
      flattened = done->flattened;
      runs.push_back(done->report.seconds);
    }
    ours.emplace_back(threads == 1 ? "1 thread" : absl::StrCat(threads, " threads"), medians(runs));
  }
  for (const auto& [threads, seconds] : ours) {
    for (const Stage& stage : kStages) {
      report.results.push_back({absl::StrCat(threads, ": ", stage.name), seconds.*stage.seconds, "s"});
    }
  }
  for (const auto& [name, preconditioner] : kReferences) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    context.progress(name, 0);
    const CgalRun cgal = run_cgal(flattened->charts, preconditioner);
    report.results.push_back({absl::StrCat(name, ": parameterise"), cgal.seconds, "s"});
    report.results.push_back({absl::StrCat(name, ": flipped triangles"), static_cast<double>(cgal.flipped), "triangles"});
    if (cgal.refused > 0) {
      report.results.push_back({absl::StrCat(name, ": refused discs"), static_cast<double>(cgal.refused), "discs"});
    }
    for (const auto& [threads, seconds] : ours) {
      const double flatten = seconds.cut + seconds.parameterise;
      report.results.push_back({absl::StrCat(threads, ": cut + parameterise / ", name), flatten, "s", cgal.seconds});
      report.results.push_back({absl::StrCat(threads, ": total / ", name), seconds.total, "s", cgal.seconds});
    }
  }
  const PreprocessReport& made = flattened->report;
  report.notes = {
      absl::StrFormat("%s: %d faces, %d discs, for %d points; median of %d runs for ours, one run for CGAL, on the same discs.",
                      file.name, made.mesh.faces, made.discs, options.points, options.repeats),
      "CGAL: Mean_value_coordinates_parameterizer_3 on a square border, time in its parameterize() alone; it solves with Eigen's "
      "BiCGSTAB, where incomplete LU is the parameteriser's default preconditioner, diagonal that of CGAL::Eigen_solver_traits."};
  return report;
}

}  // namespace curvecast::cli::bench
