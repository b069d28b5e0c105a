// The mesh itself, as a session sends it to clients that would have more bytes of points.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <string>

#include "client/bench/picture/shaded_mesh.h"
#include "client/lib/connection.h"

namespace curvecast::cli::bench {

struct SentSurface {
  std::unique_ptr<const ShadedMesh> mesh;  // with positions as they come
  std::uint64_t bytes = 0;
};

/// Errors as of Client::get_surface(): FailedPrecondition and OutOfRange where the session sends points only; DataLoss where
/// Draco cannot read what it sends.
absl::StatusOr<SentSurface> fetch_surface(const std::shared_ptr<client::Connection>& connection, const std::string& session_id);

/// When the viewer has the mesh sent: once the points that have come, and those of the view that it is about to ask for, would
/// take more bytes than it. What both take is estimated by their numbers, as the viewer does (mesh_choice.ts).
bool is_mesh_better(std::uint64_t faces, std::uint64_t bytes_so_far, std::uint64_t next_points);

}  // namespace curvecast::cli::bench
