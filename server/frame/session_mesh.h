// Makes a triangle mesh of the points of a session that one request asks for.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/measure/triangle_angles.h"
#include "core/mesh/topology.h"
#include "core/remesh/remesh.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

struct SessionMesh {
  PointSet vertices;                // with places, normals and radii; colours where the surface has any
  std::vector<Triangle> triangles;  // of the vertices
  Topology topology;                // without the components of faces
  LeastAngles angles;
};

/// Samples the session as `request` says and remeshes it. Waits for ranked candidates to be made. Errors as of SessionSampler and
/// remesh(); FailedPrecondition where fewer points have a place than were asked for.
absl::StatusOr<SessionMesh> make_session_mesh(const Session& session, PointSetRequest request, const RemeshOptions& options,
                                              ViewCache& cache, const ExecutionContext& context);

}  // namespace curvecast::server
