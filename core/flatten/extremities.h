// Where to cut a surface open so that its map to the square is stretched least: ears, fingers, feet.
// Source: Gu, Gortler, Hoppe, "Geometry images" (2002), section 3, on a coarse mesh in place of the whole one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/vertex_hierarchy.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct ExtremityOptions {
  int most = 30;                     // count of cuts
  std::size_t proxy_vertices = 800;  // at most, of the coarse mesh on which cuts are tried; at least 64
  double least_gain = 0.01;          // a cut has to lower the L2 stretch by this part of it
  int patience = 3;                  // count of cuts in a row that may fail to: limbs often gain only together
  double good_stretch = 1.1;         // L2 stretch, 1 = isometric, at which there is no need to go on
  double least_reach = 0.1;          // a point nearer to the cut than this, in square roots of the area, gets none
};

struct Extremities {
  std::vector<std::uint32_t> vertices;
  double stretch = 1;                          // L2 stretch that the map of the piece will have, about
  std::vector<VertexHierarchy::Level> levels;  // of the search's coarse mesh, for the map of the piece that has been cut
};

/// Vertices of the connected piece to cut to, in this order. On a closed surface of genus 0 the first two are the ends of the cut
/// that opens it. Every one of them lowers the stretch of the map of a coarse mesh to the square, measured by mapping it. Empty
/// for pieces too small to gain anything.
Extremities find_extremities(const TriangleMesh& piece, const ExtremityOptions& options = {},
                             const ExecutionContext& context = {});

}  // namespace curvecast
