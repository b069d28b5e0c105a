// Where the borders of charts lie on their surface: its cuts, and what there is of its own borders.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/flatten/chart_view.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// A border halfedge of a chart, and the part of the surface's halfedge, from `first` to `last` of its length, along which it
/// runs.
struct BorderPiece {
  std::uint32_t halfedge;  // of the chart
  std::uint32_t edge;      // halfedge of the surface
  double first, last;      // exactly 0 and 1 at the ends of the edge
};

/// The border of a chart, one halfedge after the other.
std::vector<BorderPiece> chart_border(const TriangleMesh& surface, const ChartView& chart);

/// Says of each halfedge of the surface whether charts meet there, or one meets itself.
std::vector<bool> cut_edges(const TriangleMesh& surface, std::span<const std::vector<BorderPiece>> borders);

}  // namespace curvecast
