// Cuts a connected piece of a mesh, of any genus and with any number of holes, open to one disc (paper, section 3.1).
// Source: Erickson, Whittlesey, "Greedy optimal homotopy and homology generators" (2005), extended by cuts to extremities.
#pragma once

#include <absl/status/statusor.h>

#include <span>

#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// All border loops and handles of the connected `piece` are joined by short paths along edges; then cuts run to the
/// `extremities` (vertices of the piece, see find_extremities). `face_of` of the result counts the piece's faces; the first of
/// its triangles are those, in their order. No edge inside the disc joins two border vertices: such edges are split at their
/// middle, because the triangles beyond them would collapse on a straight border. InvalidArgument when the piece is not connected
/// or has no faces.
absl::StatusOr<DiscMesh> cut_to_disc(const TriangleMesh& piece, std::span<const std::uint32_t> extremities = {});

}  // namespace curvecast
