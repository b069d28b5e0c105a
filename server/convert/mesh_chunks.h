// Converts what is asked of a triangle mesh, and the mesh to messages.
#pragma once

#include <absl/status/statusor.h>

#include <functional>
#include <span>

#include "core/curve/surface_curve.h"
#include "core/measure/triangle_angles.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/topology.h"
#include "core/remesh/remesh.h"
#include "core/sample/point_set.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Converts how a mesh is to be made. InvalidArgument names the field at fault and its value.
absl::StatusOr<RemeshOptions> to_remesh_options(const v1::RemeshRequest& request);

/// A triangle mesh of a session's points.
struct SessionMesh {
  PointSet vertices;                     // with places, normals and radii; colours where the surface has any
  std::vector<ScalarAttribute> scalars;  // all that the mesh has, at the vertices
  std::vector<Triangle> triangles;       // of the vertices
  Topology topology;                     // without the components of faces
  LeastAngles angles;
};

/// Hands each message to `emit` as soon as it is packed: the information, the vertices (with places and scalars), the triangles.
/// `curve`: of the session. Cancelled: `emit` returned false.
absl::Status make_mesh_chunks(const SessionMesh& mesh, const SurfaceCurve& curve,
                              const std::function<bool(v1::RemeshResponse)>& emit);

}  // namespace curvecast::server
