// SPDX-License-Identifier: Apache-2.0
// The client's point set: what a file or a frame holds, with no tie to the core.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace curvecast::client {

/// A number that the mesh has for each of its vertices, at the points.
struct ScalarColumn {
  std::string name;           // as the mesh file has it
  std::vector<float> values;  // of each point; NaN and infinities as in the file

  bool operator==(const ScalarColumn&) const = default;
};

/// Lengths in the units of the mesh. A point stands at origin + position. `normals` (unit length), `radii` (of a splat),
/// `colours` (red, green, blue; sRGB) and what follows have as many elements as `positions`, or none when the source lacks them.
struct Points {
  std::array<double, 3> origin{};
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<float> radii;
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<float, 2>> curvatures;  // least and largest principal curvature, 1/unit
  std::vector<std::uint32_t> ranks;              // of the progressive sampler
  std::vector<std::uint32_t> faces;              // polygons of the mesh's file, counted from 0
  std::vector<std::array<float, 2>>
      barycentric;                               // weights of the second and third corner of that polygon, or of a triangle of it
  std::vector<std::array<float, 3>> directions;  // of the least principal curvature: unit tangents, in one of their two senses
  std::vector<ScalarColumn> scalars;             // none when the source lacks them; their names differ

  std::size_t size() const { return positions.size(); }
};

}  // namespace curvecast::client
