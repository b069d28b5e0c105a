// The lines of a surface that meshes of it keep: its borders, and its features, such as edges so sharp that they are meant.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct SurfaceLine {
  std::vector<std::uint32_t> halfedges;  // of the mesh, each from where the one before ends
  bool is_border = false;                // of a feature either halfedge stands for the edge
  bool is_closed = false;                // the last one ends where the first begins, at a vertex like any other of the line
  bool has_loose_end = false;            // one end lies on no other line
};

/// Says of each halfedge whether the normals of the faces beside it differ by more than so many degrees.
std::vector<bool> sharp_edges(const TriangleMesh& mesh, double degrees, const ExecutionContext& context = {});

/// Lists the borders, then the features. A feature ends where other than two of its kind meet, and on borders. `features`: per
/// halfedge, the same for both of an edge, none on a border; empty: there are none.
std::vector<SurfaceLine> surface_lines(const TriangleMesh& mesh, std::vector<bool> features,
                                       const ExecutionContext& context = {});

}  // namespace curvecast
