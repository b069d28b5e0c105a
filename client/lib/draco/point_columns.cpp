// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/point_columns.h"

#include <absl/strings/str_cat.h>

#include <cmath>

namespace curvecast::client {
namespace {

absl::Status check_vectors(std::span<const std::array<float, 3>> values, absl::string_view name) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& [x, y, z] = values[i];
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      return absl::InvalidArgumentError(absl::StrCat("the ", name, " of point ", i, " is not finite"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_finite(const PointColumns& columns) {
  if (absl::Status status = check_vectors(columns.positions, "position"); !status.ok()) return status;
  if (absl::Status status = check_vectors(columns.normals, "normal"); !status.ok()) return status;
  for (std::size_t i = 0; i < columns.radii.size(); ++i) {
    if (!std::isfinite(columns.radii[i]) || columns.radii[i] < 0) {
      return absl::InvalidArgumentError(absl::StrCat("the radius of point ", i, " is ", columns.radii[i]));
    }
  }
  return absl::OkStatus();
}

}  // namespace curvecast::client
