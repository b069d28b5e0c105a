// Makes a triangle mesh of the points of a session that one request asks for.
#pragma once

#include <absl/status/statusor.h>

#include "core/remesh/remesh.h"
#include "server/convert/mesh_chunks.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// Samples the session as `request` says and remeshes it. Waits for ranked candidates to be made. Errors as of SessionSampler and
/// remesh(); FailedPrecondition where fewer points have a place than were asked for.
absl::StatusOr<SessionMesh> make_session_mesh(const Session& session, PointSetRequest request, const RemeshOptions& options,
                                              ViewCache& cache, const ExecutionContext& context);

}  // namespace curvecast::server
