// How time and memory of preprocessing grow with the number of faces.
#pragma once

#include <absl/status/statusor.h>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct GrowthOptions {
  int levels = 2;                 // count of subdivisions, each with four times the faces: 1 .. 6
  std::uint64_t points = 65'536;  // N for which the curve is made, of every size
};

/// For every size: seconds of each stage and the peak of resident memory per face; between sizes the exponent p of seconds ~
/// faces^p; beside the totals those of simplification_chain(). Finer meshes are made in memory by subdivide() and so are not read
/// and not repaired. InvalidArgument for a number of levels out of range, or that makes more than 2^30 faces; else errors as of
/// preprocess().
absl::StatusOr<BenchReport> bench_growth(const MeshFile& file, const GrowthOptions& options, const ExecutionContext& context);

}  // namespace curvecast::cli::bench
