// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/point_columns.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace curvecast::formats {
namespace {

bool finite(const std::array<float, 3>& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

absl::Status check_length(std::size_t points, std::string_view name, std::size_t length) {
  if (length == 0 || length == points) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat("%d positions do not go with %d values of %s", points, length, name));
}

absl::Status check_lengths(const PointColumns& columns) {
  const std::size_t points = columns.size();
  absl::Status status = check_length(points, "normals", columns.normals.size());
  status.Update(check_length(points, "radii", columns.radii.size()));
  status.Update(check_length(points, "colours", columns.colours.size()));
  status.Update(check_length(points, "curvatures", columns.curvatures.size()));
  status.Update(check_length(points, "ranks", columns.ranks.size()));
  status.Update(check_length(points, "faces", columns.faces.size()));
  status.Update(check_length(points, "barycentric", columns.barycentric.size()));
  status.Update(check_length(points, "directions", columns.directions.size()));
  for (const NamedColumn& scalar : columns.scalars) status.Update(check_length(points, scalar.name, scalar.values.size()));
  return status;
}

}  // namespace

absl::Status check_columns(const PointColumns& columns) {
  if (columns.size() > std::numeric_limits<std::uint32_t>::max()) {
    return absl::InvalidArgumentError(absl::StrFormat("%d points are more than a file holds", columns.size()));
  }
  if (absl::Status status = check_lengths(columns); !status.ok()) return status;
  for (const double coordinate : columns.origin) {
    if (!std::isfinite(coordinate)) return absl::InvalidArgumentError("the origin of the points is not finite");
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!finite(columns.positions[i])) return absl::InvalidArgumentError(absl::StrFormat("the position of point %d is not finite", i));
  }
  for (std::size_t i = 0; i < columns.normals.size(); ++i) {
    const std::array<float, 3>& n = columns.normals[i];
    if (!finite(n) || n == std::array<float, 3>{}) {
      return absl::InvalidArgumentError(absl::StrFormat("the normal of point %d has no direction", i));
    }
  }
  for (std::size_t i = 0; i < columns.radii.size(); ++i) {
    if (!std::isfinite(columns.radii[i]) || columns.radii[i] < 0) {
      return absl::InvalidArgumentError(absl::StrFormat("the radius of point %d is %g", i, columns.radii[i]));
    }
  }
  return absl::OkStatus();
}

std::vector<std::uint32_t> rank_order(const PointColumns& columns) {
  std::vector<std::uint32_t> order(columns.size());
  std::iota(order.begin(), order.end(), 0U);
  if (!columns.ranks.empty()) {
    std::stable_sort(order.begin(), order.end(),
                     [ranks = columns.ranks](std::uint32_t a, std::uint32_t b) { return ranks[a] < ranks[b]; });
  }
  return order;
}

double Box::extent() const {
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, double{high[axis]} - double{low[axis]});
  return longest;
}

Box box_of(std::span<const std::array<float, 3>> positions) {
  Box box{positions.front(), positions.front()};
  for (const std::array<float, 3>& position : positions) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], position[axis]);
      box.high[axis] = std::max(box.high[axis], position[axis]);
    }
  }
  return box;
}

}  // namespace curvecast::formats
