// Cuts a connected piece of a mesh, of any genus and with any number of holes, open to one disc (paper, section 3.1).
// Source: Erickson, Whittlesey, "Greedy optimal homotopy and homology generators" (2005), extended by cuts to extremities.
#pragma once

#include <absl/status/statusor.h>

#include <span>

#include "core/flatten/disc_mesh.h"

namespace curvecast {

struct CutOptions {
  int max_extremities = 20;  // count of cuts added towards the points farthest from the border
  double min_reach = 0.36;   // a point nearer to the border than this, in square roots of the piece's area, gets no cut
};

/// Cuts the piece made of `faces` (ascending, connected through twins). Twins that leave the piece count as border.
/// All border loops and handles are joined by short paths along edges; then cuts run to the extremities (ears, fingers,
/// feet), which is what keeps a parameterisation's distortion low. No edge inside the disc joins two border vertices: such
/// edges are split at their middle, because the triangles beyond them would collapse on a straight border.
/// InvalidArgument when the faces are not connected or there are none.
absl::StatusOr<DiscMesh> cut_to_disc(const TriangleMesh& mesh, std::span<const std::uint32_t> faces,
                                     const CutOptions& options = {});

}  // namespace curvecast
