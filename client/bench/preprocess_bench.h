// How long preprocessing takes, stage by stage, beside CGAL's parameteriser on the same discs in the same run.
#pragma once

#include <absl/status/statusor.h>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct PreprocessBenchOptions {
  int repeats = 3;                // count; the median counts
  std::uint64_t points = 65'536;  // N for which the curve is made
};

/// Cases: every stage with one thread and with all cores; CGAL's parameteriser, once for each preconditioner of its solver, on
/// the discs that our own cutting made; and "cut + parameterise" and "total" with CGAL's times as references. Errors as of
/// preprocess(). The context's number of threads is ignored.
absl::StatusOr<BenchReport> bench_preprocess(const MeshFile& file, const PreprocessBenchOptions& options,
                                             const ExecutionContext& context);

}  // namespace curvecast::cli::bench
