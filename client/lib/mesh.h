// A triangle mesh made of points, as the server sends it.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "points.h"

namespace curvecast::client {

struct Mesh {
  Points vertices;                                      // with normals, radii and places on the repaired mesh
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of the vertices, counter-clockwise seen from outside
  v1::RemeshInfo info;
};

/// Joins the chunks. DataLoss unless there are as many vertices and triangles as announced, with arrays of matching lengths,
/// finite numbers, and triangles between three different vertices.
absl::StatusOr<Mesh> decode_mesh(std::span<const v1::RemeshResponse> responses);

}  // namespace curvecast::client
