// The mesh of a surface of which only triangles and borders are at hand.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Finds which triangles are neighbours again. `view`: a mesh as repair() leaves it; `borders`: its halfedges without a twin,
/// ascending. They matter where repair() has opened edges whose vertices the faces still share. FailedPrecondition where
/// neighbours cannot be told: two edges inside the surface join the same two vertices. Cancelled.
absl::StatusOr<TriangleMesh> surface_mesh(const MeshView& view, std::span<const std::uint32_t> borders,
                                          const ExecutionContext& context = {});

}  // namespace curvecast
