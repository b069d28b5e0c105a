// The Hausdorff distances of table 2: a mesh beside what remeshing makes of it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "client/bench/paper/hosted_mesh.h"
#include "client/bench/paper/paper_report.h"
#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// The mesh as core has it.
TriangleMesh to_triangle_mesh(const client::Mesh& mesh);

/// Remeshes with each of the percentages of the triangles, in every way, and measures the distances of the surfaces. `original`:
/// the same mesh as `hosted`, repaired. `samples`: of each surface, for means. Errors as of HostedMesh; Cancelled.
absl::StatusOr<std::vector<RemeshError>> measure_remesh_errors(const HostedMesh& hosted, const TriangleMesh& original,
                                                               std::span<const int> percentages, std::uint64_t samples,
                                                               const ExecutionContext& context);

}  // namespace curvecast::cli::bench
