#include "client/lib/surface.h"

#include <absl/strings/str_format.h>

namespace curvecast::client {

absl::StatusOr<Surface> join_surface(std::span<const v1::GetSurfaceResponse> responses) {
  if (responses.empty() || !responses.front().has_info()) {
    return absl::DataLossError("the server sent a surface without its beginning");
  }
  Surface surface{responses.front().info(), {}};
  for (const v1::GetSurfaceResponse& response : responses.subspan(1)) {
    if (response.has_info()) return absl::DataLossError("the server sent a surface with two beginnings");
    surface.drc += response.chunk();
  }
  if (surface.drc.size() != surface.info.bytes()) {
    return absl::DataLossError(
        absl::StrFormat("the server sent %d bytes of a surface of %d", surface.drc.size(), surface.info.bytes()));
  }
  // "DRACO", two bytes of a version, and 1 for a mesh.
  if (surface.drc.size() < 8 || !surface.drc.starts_with("DRACO") || surface.drc[7] != 1) {
    return absl::DataLossError("the server sent a surface that is no mesh in Draco's form");
  }
  return surface;
}

}  // namespace curvecast::client
