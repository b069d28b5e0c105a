// SPDX-License-Identifier: Apache-2.0
// Points as columns that somebody else owns, which the writers of this folder make files of.
#pragma once

#include <absl/status/status.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace curvecast::formats {

/// A number of each point, under the name that the mesh has for it.
struct NamedColumn {
  std::string_view name;
  std::span<const float> values;  // NaN and infinities as the mesh has them
};

/// N points. Lengths in the units of the mesh. A point stands at origin + position. Every column has N elements, or none where it is
/// not known.
struct PointColumns {
  std::array<double, 3> origin{};
  std::span<const std::array<float, 3>> positions, normals;   // normals: unit length
  std::span<const float> radii;                               // of discs, neighbouring ones of which overlap
  std::span<const std::array<std::uint8_t, 3>> colours;       // red, green, blue; sRGB
  std::span<const std::array<float, 2>> curvatures;           // least and largest principal curvature, 1/unit
  std::span<const std::uint32_t> ranks;                       // of the progressive sampler: the first k ranks are a point set, too
  std::span<const std::uint32_t> faces;                       // of the repaired mesh
  std::span<const std::array<float, 2>> barycentric;          // weights of the face's second and third corner
  std::span<const std::array<float, 3>> directions;           // of the least principal curvature
  std::vector<NamedColumn> scalars;

  std::size_t size() const { return positions.size(); }
  /// Returns a coordinate in the frame of the mesh.
  double absolute(std::size_t point, int axis) const { return origin[axis] + double{positions[point][axis]}; }
};

/// InvalidArgument: a column of another length than the positions; 2^32 points or more; an origin or a position that is not finite, a
/// radius that is not finite or below 0, a normal that has no direction (the point is named).
absl::Status check_columns(const PointColumns& columns);

/// Returns the order in which all files have their points: by rank, points of the same rank as they come; without ranks as they come.
/// So the first points of a file are a coarser point set. Precondition: check_columns() is OK.
std::vector<std::uint32_t> rank_order(const PointColumns& columns);

/// The box of the points, relative to the origin. Precondition: there are points.
struct Box {
  std::array<float, 3> low, high;

  /// Returns the longest side.
  double extent() const;
};
Box box_of(std::span<const std::array<float, 3>> positions);

}  // namespace curvecast::formats
