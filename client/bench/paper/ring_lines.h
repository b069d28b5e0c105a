// Figure 5 and the gradients of table 2: how the discrepancy over rings of triangles falls with the number of points.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "client/bench/paper/paper_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

/// Returns the lines of jittered points in both ways, of the progressive sampler, of random points and of random ones in each
/// triangle. `sizes`: N of the sets, two at least, ascending. The curves are made for `curve_points`: of ten times as many
/// vertices. Errors as of preprocess() and ring_test().
absl::StatusOr<std::vector<RingLine>> measure_ring_lines(const MeshFile& file, std::span<const double> sizes,
                                                         std::uint64_t curve_points, std::uint64_t seed,
                                                         const ExecutionContext& context);

}  // namespace curvecast::cli::bench
