// How long it takes to lay the curve: the adaptive quadtree, its vertices on the surface, and their area elements.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct CurveBenchOptions {
  int repeats = 5;                         // count; the median counts
  std::uint64_t points = 65'536;           // N for which the curve is made
  std::uint64_t large_points = 1'048'576;  // N of one more run, with all cores; 0 = none
};

/// Cases: curve, map, area and their sum with one thread and with all cores, each sum beside the time that it takes as many
/// threads to write as many bytes as the curve has to fresh memory: no curve can be laid faster. Then the time to
/// divide every leaf once, with all cores, beside that of the whole first build; and one run for `large_points`,
/// with its memory. Errors as of preprocess(). The context's number of threads is ignored.
absl::StatusOr<BenchReport> bench_curve(const MeshFile& file, const CurveBenchOptions& options, const ExecutionContext& context);

}  // namespace curvecast::cli::bench
