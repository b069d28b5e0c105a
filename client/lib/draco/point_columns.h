// Where decoded points go: a part of what a frame or a file holds.
#pragma once

#include <absl/status/status.h>

#include <array>
#include <cstdint>
#include <span>

#include "client/lib/points.h"

namespace curvecast::client {

/// As many elements each as there are points; none of those that are not wanted.
struct PointColumns {
  std::span<std::array<float, 3>> positions, normals;
  std::span<float> radii;
  std::span<std::array<std::uint8_t, 3>> colours;
};

/// `count` points from `begin` on, of every column that has any.
PointColumns columns_of(Points& points, std::size_t begin, std::size_t count);

/// InvalidArgument for places, normals or radii that are not finite, and for radii below zero.
absl::Status check_finite(const PointColumns& columns);

}  // namespace curvecast::client
