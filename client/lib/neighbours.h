// SPDX-License-Identifier: Apache-2.0
// The neighbours of the points of a set, as the server finds them.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "points.h"

namespace curvecast::client {

/// The lists of all points, one after the other: that of point i has entries [begins[i], begins[i + 1]) of the last two.
struct Neighbours {
  Points points;                       // N
  v1::FrameStatistics statistics;      // of the points
  std::vector<std::size_t> begins;     // N + 1
  std::vector<std::uint32_t> indices;  // among the points
  std::vector<float> distances;        // units

  std::span<const std::uint32_t> of(std::size_t i) const {
    return std::span(indices).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

/// Joins the messages that answer `request`. DataLoss unless there are as many points as that asks for, each has as many
/// neighbours, and these are other points of the set at distances that are finite and not negative.
absl::StatusOr<Neighbours> decode_neighbours(std::span<const v1::FindNeighboursResponse> responses,
                                             const v1::FindNeighboursRequest& request);

}  // namespace curvecast::client
