// SPDX-License-Identifier: Apache-2.0
// Triangle meshes as the server sends them: made of points, and the surface of a session itself.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "points.h"

namespace curvecast::client {

struct Mesh {
  Points vertices;                                      // with normals, radii and places on the file's mesh
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of the vertices, counter-clockwise seen from outside
  v1::RemeshInfo info;
};

/// Joins the chunks. DataLoss unless there are as many vertices and triangles as announced, with arrays of matching lengths,
/// finite numbers, and triangles between three different vertices.
absl::StatusOr<Mesh> decode_mesh(std::span<const v1::RemeshResponse> responses);

/// The surface of a session itself.
struct Surface {
  v1::SurfaceInfo info;
  std::string drc;  // a mesh, as Draco's own draco_decoder opens it; positions are relative to the info's origin
};

/// Joins the chunks. DataLoss unless there are as many bytes as announced, of a mesh in Draco's form. What the bytes say is not
/// looked at.
absl::StatusOr<Surface> join_surface(std::span<const v1::GetSurfaceResponse> responses);

}  // namespace curvecast::client
