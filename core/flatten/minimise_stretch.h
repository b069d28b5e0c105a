// Maps a disc to the unit square with the least stretch, from coarse to fine, without ever flipping a triangle.
// Source: hierarchical parameterisation as in Hormann, Greiner, Campagna, "Hierarchical parametrization of triangulated surfaces"
// (1999), with the stretch of Sander, Snyder, Gortler, Hoppe, "Texture mapping progressive meshes" (2001).
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/disc_mesh.h"
#include "core/flatten/vertex_hierarchy.h"

namespace curvecast {

struct MinimiseStretchOptions {
  std::size_t coarsest = 64;  // count of vertices at which coarsening stops
  double growth = 1.6;        // a level is relaxed when it has this many times the vertices of the last one that was
  double good_enough = 0.01;  // relaxing a level ends when a sweep lowers the stretch energy by less than this part
  int most_sweeps = 100;      // count, on the coarsest levels; fewer and fewer on finer ones
  double work = 5e5;          // vertices in the sweeps of a level beyond the first, at most
  double corner_play = 0;     // of the border's length: how far corners go for where it turns, see square_border()
  std::span<const VertexHierarchy::Level> levels;  // of the mesh that the disc was cut from, see coarsen_like(); or empty
};

/// uv in [0, 1]^2 of every vertex. The border goes once around the square with four of its vertices on the corners, chosen by
/// square_border(); the others slide along their side. Time is linear in the number of vertices. The same result on any number of
/// threads. Internal where some vertex finds no valid place, which takes a region too narrow for doubles; Cancelled.
absl::StatusOr<std::vector<Vec2d>> minimise_stretch(const DiscMesh& disc, const MinimiseStretchOptions& options = {},
                                                    const ExecutionContext& context = {});

}  // namespace curvecast
