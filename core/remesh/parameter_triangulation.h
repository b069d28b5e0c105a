// Triangulates points in the square that the surface is mapped to, and stitches its cuts: the paper's way (section 4.4).
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/chart_view.h"
#include "core/remesh/chart_borders.h"
#include "core/remesh/line_points.h"

namespace curvecast {

/// What is to be triangulated: points inside of charts, and on the lines that bound these.
struct ParameterPoints {
  std::span<const FacePlace> inner;
  std::span<const SurfaceLine> lines;  // the surface's borders, and all cuts
  const LinePoints& on_lines;          // all lines are used
};

/// Makes Delaunay's triangulation of every chart in the plane, and joins those at their cuts, which have the same vertices on
/// both sides. Vertices are numbered as those of the surface, of which corners stay; then the inner points, then those on lines;
/// their positions are not set. `borders`: of each chart. InvalidArgument: too few points, or cuts so near to each other that two
/// edges would join the same two vertices. Cancelled.
absl::StatusOr<TriangleMesh> triangulate_in_parameter(const TriangleMesh& surface, std::span<const ChartView> charts,
                                                      std::span<const std::vector<BorderPiece>> borders,
                                                      const ParameterPoints& points, const ExecutionContext& context = {});

}  // namespace curvecast
