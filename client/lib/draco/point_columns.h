// SPDX-License-Identifier: Apache-2.0
// Where decoded points go.
#pragma once

#include <absl/status/status.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace curvecast::client {

/// A part of what somebody else holds. As many elements each as there are points; none of those that are not wanted.
struct PointColumns {
  std::span<std::array<float, 3>> positions, normals;
  std::span<float> radii;
  std::span<std::array<std::uint8_t, 3>> colours;
};

/// The same, with memory of its own.
struct DecodedPoints {
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<float> radii;
  std::vector<std::array<std::uint8_t, 3>> colours;

  PointColumns columns() { return {positions, normals, radii, colours}; }
};

/// InvalidArgument for places, normals or radii that are not finite, and for radii below zero.
absl::Status check_finite(const PointColumns& columns);

}  // namespace curvecast::client
