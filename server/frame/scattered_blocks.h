// Answers Scatter: places points on a mesh and packs them into messages.
#pragma once

#include <absl/status/statusor.h>

#include <functional>

#include "core/pipeline/pipeline.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/scatter_request.h"

namespace curvecast::server {

/// Hands points that are scattered on a mesh to `emit`, in blocks and in order, each as soon as it is packed. The last message
/// carries the statistics. Cancelled: `emit` returned false, or `context` is cancelled. Errors as of scatter_mesh().
absl::Status make_scattered_blocks(const LoadedMesh& mesh, const ScatterRequest& request, const ExecutionContext& context,
                                   const std::function<bool(v1::ResampleResponse)>& emit);

}  // namespace curvecast::server
