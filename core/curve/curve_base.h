// Holds what a curve lies on, in the form in which its refinement wants it.
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
  CurveBase(const CurveBase&) = delete;

  ParameterMesh mesh_of(std::size_t disc) const { return ParameterMesh(charts[disc]); }

  SurfaceData data;
  const std::vector<Chart>& charts;
  std::vector<SurfaceMapper> mappers;      // of each chart
  std::vector<std::uint8_t> fills_square;  // of each chart: see fill_square()
  std::vector<std::uint32_t> triangle_of;  // of each face: the first triangle, of its disc, that is a part of it
};

/// Starts the curve that follows `curve` on the same surface: sets everything but its vertices.
SurfaceCurve next_revision(const SurfaceCurve& curve);

}  // namespace curvecast
