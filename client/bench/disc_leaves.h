// The leaves of every disc, as preprocessing makes them, for benchmarks of the stages that start from them.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"
#include "core/pipeline/pipeline.h"

namespace curvecast::cli::bench {

struct DiscLeaves {
  Column<ParameterTriangle> triangles;
  QuadtreeLeaves leaves;
};

/// One for each chart: those of a curve for `points` points at uniform density and the default omega.
absl::StatusOr<std::vector<DiscLeaves>> disc_leaves(const FlattenedMesh& flattened, std::uint64_t points,
                                                    const ExecutionContext& context);

}  // namespace curvecast::cli::bench
