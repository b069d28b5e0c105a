// The two area elements: which gives the more even samples, at what cost.
#pragma once

#include <absl/status/statusor.h>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct AreasBenchOptions {
  int runs = 8;                   // count: sets of samples drawn with different seeds, for the noise
  int regions = 256;              // of the discrepancy
  std::uint64_t points = 65'536;  // N for which the curve is made
  std::uint64_t seed = 0;
};

/// Seconds of both area elements and how far their sums miss the surface's area before they are normalised; the ring discrepancy
/// of jittered samples drawn with each, and of random samples, for N = 2^l and 2^l + 2^(l - 1) up to a tenth of the curve's
/// vertices (paper, section 4.2). Errors as of preprocess().
absl::StatusOr<BenchReport> bench_areas(const MeshFile& file, const AreasBenchOptions& options, const ExecutionContext& context);

}  // namespace curvecast::cli::bench
