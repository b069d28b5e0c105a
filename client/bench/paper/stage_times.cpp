#include "client/bench/paper/stage_times.h"

#include <algorithm>
#include <limits>

#include "core/base/stopwatch.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kSamples = 100;  // point sets of each prepared mesh

/// Seconds to make a point set, the fastest of several.
absl::StatusOr<double> seconds_to_sample(const SurfaceCurve& curve, std::uint64_t points) {
  ResampleWorkspace workspace;
  double fastest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSamples; ++i) {
    Stopwatch watch;
    const ResampleOptions options{.points = points, .seed = static_cast<std::uint64_t>(i)};
    if (absl::Status status = resample(curve, nullptr, options, workspace); !status.ok()) return status;
    fastest = std::min(fastest, watch.lap());
  }
  return fastest;
}

}  // namespace

absl::StatusOr<StageTimes> measure_stages(const MeshFile& file, Way way, std::uint64_t points, int repeats,
                                          const ExecutionContext& context) {
  StageTimes fastest;
  for (int i = 0; i < repeats; ++i) {
    const absl::StatusOr<Preprocessed> made = preprocess(file, preprocess_options(way, points), context);
    if (!made.ok()) return made.status();
    const absl::StatusOr<double> sample = seconds_to_sample(*made->curve, points);
    if (!sample.ok()) return sample.status();
    const StageSeconds& s = made->report.seconds;
    const StageTimes times{s.cut + s.parameterise, s.curve + s.area, s.map, *sample, s.total + *sample};
    if (i == 0) fastest = times;
    for (const TableStage& stage : kTableStages) {
      fastest.*stage.seconds = std::min(fastest.*stage.seconds, times.*stage.seconds);
    }
  }
  return fastest;
}

}  // namespace curvecast::cli::bench
