// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/splats.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvecast::formats {
namespace {

constexpr double kHarmonic = 0.28209479177387814;  // 1 / (2 sqrt(pi))
constexpr float kLeastRadius = 1e-6F;              // of the largest

// Where light comes from, for points without colours; a unit vector. The side that it does not reach is not black.
constexpr std::array<double, 3> kLight = {0.48, 0.64, 0.6};
constexpr double kDarkest = 64, kBrightest = 232;

/// Discs are the same from both sides, so that the half turn, for which this is ill-conditioned, never happens.
std::array<float, 4> rotation_to(std::array<double, 3> n) {
  if (n[2] < 0) n = {-n[0], -n[1], -n[2]};
  const double w = 1 + n[2];
  const double length = std::sqrt(w * w + n[0] * n[0] + n[1] * n[1]);
  return {static_cast<float>(-n[1] / length), static_cast<float>(n[0] / length), 0.0F, static_cast<float>(w / length)};
}

std::array<std::uint8_t, 3> shaded(const std::array<double, 3>& n) {
  const double cosine = n[0] * kLight[0] + n[1] * kLight[1] + n[2] * kLight[2];
  const auto grey = static_cast<std::uint8_t>(std::lround(kDarkest + (kBrightest - kDarkest) * 0.5 * (1 + cosine)));
  return {grey, grey, grey};
}

}  // namespace

absl::StatusOr<Splats> make_splats(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  Splats splats;
  splats.origin = columns.origin;
  if (columns.size() == 0) return splats;
  if (columns.normals.empty() || columns.radii.empty()) {
    return absl::InvalidArgumentError("splats are made of points with normals and radii");
  }
  const float largest = *std::max_element(columns.radii.begin(), columns.radii.end());
  if (!(largest > 0)) return absl::InvalidArgumentError("splats are made of points one of which has a radius above 0");
  for (const std::uint32_t i : rank_order(columns)) {
    std::array<double, 3> n = {columns.normals[i][0], columns.normals[i][1], columns.normals[i][2]};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& coordinate : n) coordinate /= length;
    splats.positions.push_back(columns.positions[i]);
    splats.normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    splats.rotations.push_back(rotation_to(n));
    const float width = kSplatWidth * std::max(columns.radii[i], kLeastRadius * largest);
    splats.widths.push_back(std::max(width, std::numeric_limits<float>::min()));  // whose logarithm is a number
    splats.colours.push_back(columns.colours.empty() ? shaded(n) : columns.colours[i]);
  }
  return splats;
}

float harmonic_of(std::uint8_t channel) { return static_cast<float>((channel / 255.0 - 0.5) / kHarmonic); }

}  // namespace curvecast::formats
