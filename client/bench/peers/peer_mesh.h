// A peer's triangles, as a mesh that can be measured.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "client/bench/peers/remeshers.h"

namespace curvecast::cli::bench {

/// Repairs them, and counts what had to be. Errors as of repair().
absl::StatusOr<PeerMesh> make_peer_mesh(std::vector<Vec3d> positions, const std::vector<Triangle>& triangles, double seconds);

}  // namespace curvecast::cli::bench
