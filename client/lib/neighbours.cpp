// SPDX-License-Identifier: Apache-2.0
#include "client/lib/neighbours.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>

#include "client/lib/append_values.h"
#include "client/lib/encoded_sample.h"
#include "client/lib/point_blocks.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

absl::Status join_points(std::span<const v1::FindNeighboursResponse> responses, const v1::SampleRequest& sample,
                         Neighbours& out) {
  google::protobuf::RepeatedPtrField<v1::PointBlock> blocks;
  std::uint64_t total = 0;
  for (const v1::FindNeighboursResponse& response : responses) {
    if (response.points().has_statistics()) out.statistics = response.points().statistics();
    if (!response.points().has_points()) continue;
    total += response.points().points().count();
    *blocks.Add() = response.points().points();
  }
  const std::uint64_t most = most_points(sample);
  if (total == 0 || total > most || (total < most && is_exact(sample))) {
    return absl::DataLossError(
        absl::StrCat("asked for ", most, " points", is_exact(sample) ? "" : " at most", ", but the server sent ", total));
  }
  absl::StatusOr<Points> points = decode_blocks(blocks);
  if (!points.ok()) return points.status();
  out.points = *std::move(points);
  return absl::OkStatus();
}

absl::Status join_lists(std::span<const v1::FindNeighboursResponse> responses, Neighbours& out) {
  std::vector<std::uint32_t> counts;
  for (const v1::FindNeighboursResponse& response : responses) {
    const v1::NeighbourChunk& chunk = response.neighbours();
    if (!append_values(chunk.counts(), counts) || !append_values(chunk.indices(), out.indices) ||
        !append_values(chunk.distances(), out.distances)) {
      return absl::DataLossError("the server sent a part of a neighbour");
    }
  }
  if (counts.size() != out.points.size()) {
    return absl::DataLossError(
        absl::StrCat("the server sent the neighbours of ", counts.size(), " points of ", out.points.size()));
  }
  out.begins.reserve(counts.size() + 1);
  out.begins.push_back(0);
  for (const std::uint32_t count : counts) out.begins.push_back(out.begins.back() + count);
  if (out.indices.size() != out.begins.back() || out.distances.size() != out.begins.back()) {
    return absl::DataLossError(absl::StrCat("the server sent ", out.indices.size(), " neighbours at ", out.distances.size(),
                                            " distances of ", out.begins.back()));
  }
  return absl::OkStatus();
}

/// Checks the lists. `length`: of each; 0: any.
absl::Status check_lists(const Neighbours& lists, std::size_t length) {
  const std::size_t n = lists.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto list = lists.of(i);
    if (length > 0 && list.size() != std::min(length, n - 1)) {
      return absl::DataLossError(absl::StrCat("asked for ", length, " neighbours, but the server sent ", list.size()));
    }
    if (!std::all_of(list.begin(), list.end(), [&](std::uint32_t j) { return j < n && j != i; })) {
      return absl::DataLossError(absl::StrCat("the server sent a neighbour that is no other one of ", n, " points"));
    }
  }
  const auto is_distance = [](float d) { return d >= 0 && std::isfinite(d); };
  if (!std::all_of(lists.distances.begin(), lists.distances.end(), is_distance)) {
    return absl::DataLossError("the server sent a distance that is none");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Neighbours> decode_neighbours(std::span<const v1::FindNeighboursResponse> responses,
                                             const v1::FindNeighboursRequest& request) {
  Neighbours out;
  if (absl::Status status = join_points(responses, request.sample(), out); !status.ok()) return status;
  if (absl::Status status = join_lists(responses, out); !status.ok()) return status;
  if (absl::Status status = check_lists(out, request.count()); !status.ok()) return status;
  return out;
}

}  // namespace curvecast::client
