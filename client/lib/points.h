// The client's point set: what a file or a frame holds, with no tie to the core.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvecast::client {

/// Lengths in the units of the mesh. A point stands at origin + position. `normals` (unit length), `radii` (of a splat)
/// and `colours` (red, green, blue; sRGB) have as many elements as `positions`, or none when the source lacks them.
struct Points {
  std::array<double, 3> origin{};
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<float> radii;
  std::vector<std::array<std::uint8_t, 3>> colours;

  std::size_t size() const { return positions.size(); }
};

}  // namespace curvecast::client
