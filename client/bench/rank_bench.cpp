#include "client/bench/rank_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "client/bench/median.h"
#include "core/base/stopwatch.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/rank_delta.h"
#include "core/progressive/rank_selection.h"
#include "core/progressive/sample_ranked.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kLevel = 9;  // 4^9 = 262,144 ranks
constexpr double kMilliseconds = 1e3;

std::vector<double> seconds_to_make(const std::shared_ptr<const LeafSurface>& surface, int times, const ExecutionContext& context,
                                    std::unique_ptr<RankGrower>& grower, absl::Status& status) {
  std::vector<double> seconds;
  ExecutionContext quiet = context;
  quiet.on_progress = nullptr;
  for (int i = 0; i < times; ++i) {
    Stopwatch watch;
    auto made = RankGrower::make(surface, {.level = kLevel}, quiet);
    seconds.push_back(watch.lap());
    if (!made.ok()) {
      status = made.status();
      return seconds;
    }
    grower = *std::move(made);
  }
  return seconds;
}

}  // namespace

Camera orbit_camera(const SurfaceCurve& curve, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3d direction(2 * std::sin(angle), 0.5, 2 * std::cos(angle));
  return {.eye = curve.box.center() + direction * curve.box.diagonal(), .target = curve.box.center()};
}

absl::Status bench_ranks(const std::shared_ptr<const LeafSurface>& surface, const SampleBenchOptions& options,
                         double read_seconds, const ExecutionContext& context, BenchReport& report) {
  const SurfaceCurve* const curve = &surface->curve();
  absl::Status status;
  std::unique_ptr<RankGrower> grower;
  const std::vector<double> make = seconds_to_make(surface, 3, context, grower, status);
  if (!status.ok()) return status;
  const auto add = [&](const std::string& name, const std::vector<double>& seconds) {
    report.results.push_back({name, kMilliseconds * median(seconds), "ms", kMilliseconds * read_seconds});
  };
  add(absl::StrCat("progressive: make ", grower->tree()->points(), " ranks, all threads"), make);

  const auto density = [&](double degrees) { return Density({ViewTerm{}}, {orbit_camera(*curve, degrees)}); };
  RankSelector selector;
  RankSelection before, after;
  // What a view lacks is made once, in the background of a server.
  for (int round = 0; round < 4 * kMaxRankLevel; ++round) {
    selector.select(grower->tree(), nullptr, ViewFactor(*curve, density(0)), options.view_points, before);
    if (before.lacking.empty()) break;
    if (status = grower->grow(before.most_lacking(), 4 * kMaxPoints, context); !status.ok()) return status;
  }
  RankDelta delta;
  RankedWorkspace workspace;
  std::vector<double> select, compare_both, step, whole;
  double added = 0, removed = 0;
  const int steps = 3 * options.repeats;
  for (int i = 1; i <= steps; ++i) {
    if (status = context.check(); !status.ok()) return status;
    Stopwatch watch;
    selector.select(grower->tree(), nullptr, ViewFactor(*curve, density(i)), options.view_points, after, before.similar_scale());
    select.push_back(watch.lap());
    compare(before, {}, after, delta);
    compare_both.push_back(watch.lap());
    step.push_back(select.back() + compare_both.back());
    added += static_cast<double>(delta.added.size()) / steps;
    removed += static_cast<double>(delta.removed.size()) / steps;
    std::swap(before, after);
    watch.lap();
    status = sample_ranked(*curve, grower->tree(), nullptr, density(i), options.view_points, workspace);
    if (!status.ok()) return status;
    whole.push_back(watch.lap());
  }
  const std::string name = absl::StrFormat("progressive view, N = %d", options.view_points);
  add(absl::StrCat(name, ", 1 degree on, with what is added and removed"), step);
  add(absl::StrCat(name, ": select"), select);
  add(absl::StrCat(name, ": compare"), compare_both);
  add(absl::StrCat(name, ", all points in order"), whole);
  report.results.push_back({absl::StrCat(name, ": added"), added, "points"});
  report.results.push_back({absl::StrCat(name, ": removed"), removed, "points"});
  return absl::OkStatus();
}

}  // namespace curvecast::cli::bench
