// Converts a triangle mesh to messages.
#pragma once

#include <absl/status/status.h>

#include <functional>
#include <span>

#include "core/curve/surface_curve.h"
#include "core/measure/triangle_angles.h"
#include "core/mesh/topology.h"
#include "core/sample/point_set.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Elements of each kind in one message, at most: under 1 MiB.
inline constexpr std::size_t kChunkMeshVertices = 16'384;
inline constexpr std::size_t kChunkMeshTriangles = 65'536;

/// Hands each message to `emit` as soon as it is packed: the information, the vertices (with places), the triangles. `curve`: of
/// the session. Cancelled: `emit` returned false.
absl::Status make_mesh_chunks(const PointSet& vertices, const std::vector<Triangle>& triangles, const Topology& topology,
                              const LeastAngles& angles, const SurfaceCurve& curve,
                              const std::function<bool(v1::RemeshResponse)>& emit);

}  // namespace curvecast::server
