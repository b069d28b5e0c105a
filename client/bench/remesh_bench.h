// Meshes made of points beside those that others make of the same surface.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct RemeshBenchOptions {
  std::uint64_t vertices = 0;  // of the new meshes; 0 = 75, 50 and 25 % of the mesh's own
  int repeats = 3;             // runs of ours, of which the fastest counts
  bool peers = true;           // beside CGAL and meshoptimizer
  std::uint64_t seed = 0;
};

/// For each number of vertices a row for each way: seconds after preprocessing, with and without sampling; distances from the
/// surface and back (of mean and RMS the larger one), % of the box's diagonal; the triangles' smallest angles; what was not
/// manifold; components, genus, borders. Errors as of preprocess() and remesh(); InvalidArgument: fewer than 10 vertices.
absl::StatusOr<BenchReport> bench_remesh(const MeshFile& file, const RemeshBenchOptions& options,
                                         const ExecutionContext& context);

}  // namespace curvecast::cli::bench
