// What a curve lies on, as its refinement wants it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/column.h"
#include "core/curve/locate_triangle.h"
#include "core/curve/parameter_triangle.h"
#include "core/curve/surface_map.h"
#include "core/flatten/flatten.h"

namespace curvecast {

/// `data` and `charts` are those that the curve was made with, and outlive it.
struct CurveBase {
  CurveBase(const SurfaceData& surface, const std::vector<Chart>& all_charts);

  ParameterMesh mesh_of(std::size_t disc) const { return {triangles[disc], charts[disc].disc.twins}; }

  SurfaceData data;
  const std::vector<Chart>& charts;
  std::vector<Column<ParameterTriangle>> triangles;  // of each chart
  std::vector<std::uint32_t> triangle_of;            // of each face: the first triangle, of its disc, that is a part of it
};

/// A curve of which everything is set but its vertices: the one that follows `curve`, on the same surface.
SurfaceCurve next_revision(const SurfaceCurve& curve);

}  // namespace curvecast
