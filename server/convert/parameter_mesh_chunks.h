// Converts a parameter mesh to messages.
#pragma once

#include <absl/status/status.h>

#include <functional>

#include "core/pipeline/pipeline.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Elements of each kind in one message, at most: under 1 MiB together.
inline constexpr std::size_t kChunkVertices = 12'288;
inline constexpr std::size_t kChunkTriangles = 16'384;
inline constexpr std::size_t kChunkBorder = 16'384;

/// Converts a mesh and hands each message to `emit` as soon as it is packed: the information, then the chunks of each disc in
/// order. Cancelled: `emit` returned false.
absl::Status make_chunks(const FlattenedMesh& flattened, const std::string& mesh_name,
                         const std::function<bool(v1::GetParameterMeshResponse)>& emit);

}  // namespace curvecast::server
