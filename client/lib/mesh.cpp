// SPDX-License-Identifier: Apache-2.0
#include "client/lib/mesh.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <utility>

#include "client/lib/append_values.h"
#include "client/lib/point_blocks.h"

namespace curvecast::client {

absl::StatusOr<Mesh> decode_mesh(std::span<const v1::RemeshResponse> responses) {
  Mesh mesh;
  const auto info = std::find_if(responses.begin(), responses.end(), [](const auto& response) { return response.has_info(); });
  if (info == responses.end()) return absl::DataLossError("the server sent no mesh");
  mesh.info = info->info();
  for (const v1::RemeshResponse& response : responses) {
    if (!response.has_chunk()) continue;
    if (response.chunk().has_vertices()) {
      absl::StatusOr<Points> block = decode_block(response.chunk().vertices());
      if (!block.ok()) return block.status();
      append_points(*std::move(block), &mesh.vertices);
    }
    if (!append_values(response.chunk().triangles(), mesh.triangles)) {
      return absl::DataLossError("the server sent a part of a triangle");
    }
  }
  const std::size_t n = mesh.vertices.size();
  if (n != mesh.info.vertices() || mesh.triangles.size() != mesh.info.triangles()) {
    return absl::DataLossError(absl::StrCat("the server sent ", n, " vertices and ", mesh.triangles.size(), " triangles of ",
                                            mesh.info.vertices(), " and ", mesh.info.triangles()));
  }
  const auto is_sound = [n](const std::array<std::uint32_t, 3>& t) {
    return t[0] < n && t[1] < n && t[2] < n && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  };
  if (!std::all_of(mesh.triangles.begin(), mesh.triangles.end(), is_sound)) {
    return absl::DataLossError(absl::StrCat("the server sent a triangle that is not between three of ", n, " vertices"));
  }
  return mesh;
}

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
