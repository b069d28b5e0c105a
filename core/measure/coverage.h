// The largest hole that points leave in a surface.
#pragma once

#include "core/base/execution_context.h"
#include "core/measure/point_cloud.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Coverage is found to this part of itself.
inline constexpr double kCoverageTolerance = 0.005;

/// The largest distance, straight through space, from a point of the surface to the nearest of the points, in the mesh's units:
/// 2 / sqrt(3) = 1.155 times packing_radius() in a hexagonal lattice. No sampling: the distance changes no faster than one moves,
/// so that a triangle whose middle is near enough to a point for its size cannot hold the largest one, and all others are halved
/// until none is left. The result is the distance of a place that there is, and at most kCoverageTolerance below the largest. The
/// same for any number of threads; too small once cancelled. Preconditions: there is a point; the mesh has an area.
double coverage_radius(const TriangleMesh& mesh, const PointCloud& points, const ExecutionContext& context = {});

}  // namespace curvecast
