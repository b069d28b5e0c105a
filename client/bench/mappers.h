// The two mappers on the same leaves.
#pragma once

#include <absl/status/statusor.h>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct MappersBenchOptions {
  int repeats = 5;                // count; the median counts
  std::uint64_t points = 65'536;  // N for which the curve is made
};

/// Seconds of the exact mapper and of the ID buffer, over all discs; the share of centres for which they name different
/// triangles, and of those that the ID buffer's texels did not place right. Errors as of preprocess() and of IdBuffer.
absl::StatusOr<BenchReport> bench_mappers(const MeshFile& file, const MappersBenchOptions& options,
                                          const ExecutionContext& context);

}  // namespace curvecast::cli::bench
