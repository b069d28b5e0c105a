// How evenly the samplers spread points, by every measure there is.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct DiscrepancyBenchOptions {
  std::uint64_t points = 262'144;  // largest of the sets whose spacing is measured
  std::uint64_t ring_points = 0;   // N for which the curve of the ring discrepancies is made; 0 = these are left out
  bool curvature = false;          // a density by curvature for the rings, weighted with it
  std::string formula;             // times the density for the rings, weighted with it: see ExpressionTerm; empty = 1
  std::uint64_t seed = 0;
  std::uint64_t chart_faces = 0;  // about how many a chart may have; 0: as preprocess() says
};

/// Of every sampler and sequence, of random points, of those in each triangle (as the paper has them), of farthest points and of
/// sample elimination: ball discrepancy relative to random points, relative radius among points on the same side, coverage
/// radius, for sets of 1,024 points and more, on the powers of four and between. Then the paper's test (section 4.2), without the
/// last two, and with a density of the samplers alone: the discrepancy over rings of triangles for 2^l and 2^l + 2^(l-1) points,
/// l = 1 to 20, up to ring_points, and the power of N by which it falls, -1/2 of random points: see ring_test(). Errors as of
/// preprocess() and resample().
absl::StatusOr<BenchReport> bench_discrepancy(const MeshFile& file, const DiscrepancyBenchOptions& options,
                                              const ExecutionContext& context);

}  // namespace curvecast::cli::bench
