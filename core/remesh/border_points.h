// Places vertices on the borders of a surface, as densely as points lie beside them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/remesh/insert_points.h"

namespace curvecast {

struct BorderPoints {
  std::vector<std::uint32_t> corners;    // vertices of the mesh that stay: where a border turns
  std::vector<BorderPlace> places;       // by edges, and along each
  std::vector<std::uint32_t> stand_ins;  // as many as both together, ascending: the points that go in their stead
};

/// Places at least three points on every border of the mesh, one after the other as far apart as the points beside them, and
/// names for each the nearest point that no other has taken: their number stays the same. Where a border turns by more than 45
/// degrees, seen from as far away as the next point, its own vertex stays. Fewer stand-ins than corners and places: there are too
/// few points. `positions`: of the points, on the mesh.
BorderPoints place_on_borders(const TriangleMesh& mesh, std::span<const Vec3d> positions, const ExecutionContext& context = {});

}  // namespace curvecast
