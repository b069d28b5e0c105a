// What a new point set costs: a change of N alone, a change of the view, stage by stage.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct SampleBenchOptions {
  int repeats = 51;                    // rounds, of which the median counts
  std::uint64_t points = 65'536;       // N for which the curve is made, and of the point sets without a view
  std::uint64_t view_points = 50'000;  // N of those under a view
  std::uint64_t seed = 0;
};

/// Cases: reading the curve's positions, normals and areas once, which is every other's reference; then, one after the other in
/// every round, with one thread: N points evenly and with curvature's density, and fewer points under a view, both alone and with
/// curvature; of each the whole and its stages, of the first and the third also in fresh memory. Errors as of preprocess() and
/// resample(). The context's number of threads is that of preprocessing.
absl::StatusOr<BenchReport> bench_sample(const MeshFile& file, const SampleBenchOptions& options,
                                         const ExecutionContext& context);

}  // namespace curvecast::cli::bench
