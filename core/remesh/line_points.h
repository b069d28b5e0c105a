// Places vertices on the lines of a surface, as densely as points lie beside them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/remesh/insert_points.h"
#include "core/remesh/surface_lines.h"

namespace curvecast {

struct LinePoints {
  std::vector<std::uint32_t> corners;    // vertices of the mesh that stay: where lines meet, end or turn
  std::vector<LinePlace> places;         // by edges, and along each
  std::vector<std::uint32_t> stand_ins;  // as many as both together, ascending: the points that go in their stead
  std::vector<bool> used;                // per line: others are too short for points
};

/// Places points on every line of the mesh, one after the other as far apart as the points beside them, at least three on a
/// closed one, and names for each the nearest point that no other has taken: their number stays the same. Where a line turns by
/// more than 45 degrees, seen from as far away as the next point, its own vertex stays. Features with a loose end that are
/// shorter than the distance of points are left out: they are noise to these. Fewer stand-ins than corners and places: there are
/// too few points. `positions`: of the points, on the mesh.
LinePoints place_on_lines(const TriangleMesh& mesh, std::span<const SurfaceLine> lines, std::span<const Vec3d> positions,
                          const ExecutionContext& context = {});

}  // namespace curvecast
