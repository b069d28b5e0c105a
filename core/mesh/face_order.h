// The faces of a mesh in the order of a Hilbert curve through space, so that those that follow one another are near each other.
// Source: Skilling, "Programming the Hilbert curve" (2004).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Lists all faces in the order in which the curve through the mesh's box passes their centroids; faces in the same cell of
/// 2^16 a side, in their own order. The same for any number of threads of the arena. Some are missing once the context is
/// cancelled.
std::vector<std::uint32_t> face_order(const TriangleMesh& mesh, const ExecutionContext& context = {});

}  // namespace curvecast
