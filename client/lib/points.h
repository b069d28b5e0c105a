// The client's point set: what a file or a frame holds, with no tie to the core.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast::client {

/// Lengths in the units of the mesh. A point stands at origin + position. `normals` (unit length), `radii` (of a splat),
/// `colours` (red, green, blue; sRGB) and what follows have as many elements as `positions`, or none when the source lacks them.
struct Points {
  std::array<double, 3> origin{};
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<float> radii;
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<float, 2>> curvatures;   // least and largest principal curvature, 1/unit
  std::vector<std::uint32_t> ranks;               // of the progressive sampler
  std::vector<std::uint32_t> faces;               // of the repaired mesh
  std::vector<std::array<float, 2>> barycentric;  // weights of the face's second and third corner

  std::size_t size() const { return positions.size(); }
};

}  // namespace curvecast::client
