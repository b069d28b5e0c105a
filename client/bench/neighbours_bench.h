// Neighbour queries through the curve's order beside nanoflann's kd-tree, on the same points in the same run.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/mesh_file.h"

namespace curvecast::cli::bench {

struct NeighboursBenchOptions {
  int repeats = 3;                 // of each, of which the median counts
  std::uint64_t points = 65'536;   // N for which the curve is made
  std::uint64_t samples = 50'000;  // points of the sample set, at most `points`
  std::uint64_t seed = 0;
};

/// Cases for the curve's vertices and for a sample set: building; the k nearest others of all points, and both together; the k
/// nearest of places beside the points, one by one; radius queries with 16 hits on average; and how many answers differ. The
/// reference is nanoflann's time. With one thread, and all points also with all cores. Errors as of preprocess() and resample().
/// The context's number of threads is ignored.
absl::StatusOr<BenchReport> bench_neighbours(const MeshFile& file, const NeighboursBenchOptions& options,
                                             const ExecutionContext& context);

}  // namespace curvecast::cli::bench
