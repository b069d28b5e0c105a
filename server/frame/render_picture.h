// Draws pictures of a session's surface, for clients that draw nothing themselves.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/execution_context.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/frame/session_sampler.h"
#include "server/session/session.h"

namespace curvecast::server {

/// Samples points for the picture's camera and splats them, or draws the mesh. Errors as of curvecast::resample; InvalidArgument
/// names a field of the request that is out of range; ResourceExhausted for a file that no answer holds; Cancelled.
absl::StatusOr<v1::RenderResponse> render_picture(const Session& session, const v1::RenderRequest& request, ViewCache& cache,
                                                  const ExecutionContext& context);

}  // namespace curvecast::server
