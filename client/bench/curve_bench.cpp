#include "client/bench/curve_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "client/bench/median.h"
#include "client/bench/peak_memory.h"
#include "client/bench/stages.h"
#include "core/base/column.h"
#include "core/base/stopwatch.h"
#include "core/pipeline/curve_surface.h"
#include "core/refine/subdivide_all.h"

namespace curvecast::cli::bench {
namespace {

/// Seconds that so many threads take to write so many bytes to a column that nobody has touched yet.
double seconds_to_write(std::uint64_t bytes, int threads) {
  Stopwatch watch;
  Column<std::uint64_t> memory;
  memory.resize(bytes / sizeof(std::uint64_t));
  std::vector<std::jthread> writers;
  const std::size_t share = memory.size() / static_cast<std::size_t>(threads);
  for (int i = 0; i < threads; ++i) {
    const std::span<std::uint64_t> part(memory.data() + static_cast<std::size_t>(i) * share, share);
    writers.emplace_back([part] { std::iota(part.begin(), part.end(), std::uint64_t{1}); });
  }
  writers.clear();
  const double seconds = watch.lap();
  const volatile std::uint64_t read = memory[share / 2];  // so that nobody finds the writing useless
  static_cast<void>(read);
  return seconds;
}

/// The stages that lay the curve, one run or the median of several.
void add_stages(const std::string& name, const StageSeconds& seconds, double bound, BenchReport& report) {
  report.results.push_back({name + ": curve", seconds.curve, "s"});
  report.results.push_back({name + ": map", seconds.map, "s"});
  report.results.push_back({name + ": area", seconds.area, "s"});
  report.results.push_back({name + ": curve + map + area", seconds.curve + seconds.map + seconds.area, "s", bound});
}

/// Seconds to divide every leaf of a curve once, the median of several runs.
double seconds_to_raise(const Preprocessed& done, int repeats) {
  const std::shared_ptr<const CurveBase> base = *curve_base(done.flattened);
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    Stopwatch watch;
    const SurfaceCurve raised = subdivide_all(*base, *done.curve, 1);
    seconds.push_back(watch.lap());
  }
  return median(seconds);
}

}  // namespace

absl::StatusOr<BenchReport> bench_curve(const MeshFile& file, const CurveBenchOptions& options, const ExecutionContext& context) {
  BenchReport report{"curve", {}};
  PreprocessOptions preprocess_options{.points = options.points};
  absl::StatusOr<FlattenedMesh> made = flatten_mesh(file, preprocess_options, context);
  if (!made.ok()) return made.status();
  const auto flattened = std::make_shared<const FlattenedMesh>(*std::move(made));
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<int> thread_counts = {1};
  if (cores > 1) thread_counts.push_back(cores);
  for (const int threads : thread_counts) {
    ExecutionContext run_context = context;
    run_context.threads = threads;
    std::vector<StageSeconds> runs;
    absl::StatusOr<Preprocessed> done;
    for (int i = 0; i < options.repeats; ++i) {
      done = lay_curve(flattened, preprocess_options, run_context);
      if (!done.ok()) return done.status();
      runs.push_back(done->report.seconds);
    }
    const PreprocessReport& last = done->report;
    if (threads == 1) {
      report.results.push_back({"curve vertices", static_cast<double>(last.curve_vertices), "vertices",
                                preprocess_options.omega * static_cast<double>(options.points)});
      report.results.push_back(
          {"curve", static_cast<double>(last.curve_bytes) / static_cast<double>(last.curve_vertices), "B/vertex"});
    }
    add_stages(threads == 1 ? "1 thread" : absl::StrCat(threads, " threads"), medians(runs),
               seconds_to_write(last.curve_bytes, threads), report);
    if (threads == cores) {
      report.results.push_back(
          {"raise: four times as many vertices", seconds_to_raise(*done, options.repeats), "s", medians(runs).total});
    }
  }
  report.notes = {
      absl::StrFormat("%s for %d points, omega %g, median of %d; the vertices' reference is what omega asks for, the sums' is "
                      "the time to write the curve's bytes to fresh memory, raise's that of all preprocessing.",
                      file.name, options.points, preprocess_options.omega, options.repeats)};
  if (options.large_points == 0) return report;
  const bool counts_memory = reset_peak_memory();
  preprocess_options.points = options.large_points;
  ExecutionContext run_context = context;
  run_context.threads = cores;
  const absl::StatusOr<Preprocessed> large = lay_curve(flattened, preprocess_options, run_context);
  if (!large.ok()) return large.status();
  const double peak_gb = static_cast<double>(peak_memory()) / 1e9;
  report.results.push_back({"large: curve vertices", static_cast<double>(large->report.curve_vertices), "vertices",
                            preprocess_options.omega * static_cast<double>(options.large_points)});
  add_stages("large", large->report.seconds, seconds_to_write(large->report.curve_bytes, cores), report);
  if (counts_memory) report.results.push_back({"large: peak memory", peak_gb, "GB"});
  report.notes.push_back(absl::StrFormat("large: for %d points, one run with all cores; memory is all that the process holds.",
                                         options.large_points));
  return report;
}

}  // namespace curvecast::cli::bench
