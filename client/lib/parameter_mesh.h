// SPDX-License-Identifier: Apache-2.0
// A surface cut into discs and mapped to the square, as the server sends it.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

struct ParameterDisc {
  std::vector<std::array<double, 3>> positions;         // V, in the file's units
  std::vector<std::array<double, 2>> uv;                // V, in [0, 1]^2
  std::vector<std::array<std::uint32_t, 3>> triangles;  // T
  std::vector<std::uint32_t> faces;                     // T: polygon of the mesh's file that holds the triangle
  std::vector<double> area_ratios;                      // T: surface area over uv area
  std::vector<std::uint32_t> border;                    // B: vertices of the border loop, counter-clockwise
  std::vector<std::uint8_t> border_cuts;                // B: 1 when the edge from there to the next is a cut
};

struct ParameterMesh {
  v1::ParameterMeshInfo info;
  std::vector<ParameterDisc> discs;
};

/// Joins the chunks. DataLoss unless there are as many discs as announced, in order, each with arrays of matching lengths,
/// indices within range, and coordinates and ratios that are finite (uv within the square, ratios not negative).
absl::StatusOr<ParameterMesh> decode_parameter_mesh(std::span<const v1::GetParameterMeshResponse> responses);

}  // namespace curvecast::client
