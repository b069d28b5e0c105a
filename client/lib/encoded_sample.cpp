// SPDX-License-Identifier: Apache-2.0
#include "client/lib/encoded_sample.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <utility>

#include "client/lib/point_blocks.h"
#include "client/lib/protocol.h"

namespace curvecast::client {

std::uint64_t most_points(const v1::SampleRequest& sample) { return sample.has_points() ? sample.points() : kMaxPoints; }

bool is_exact(const v1::SampleRequest& sample) {
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE) return false;
  const auto lowers = [](const v1::DensityTerm& term) { return term.distance().global(); };
  return sample.has_points() && std::none_of(sample.density().begin(), sample.density().end(), lowers);
}

void SampleGatherer::add(v1::ResampleResponse& response) {
  if (response.has_statistics()) sample_.statistics = response.statistics();
  if (!response.has_points()) return;
  points_ += response.points().count();
  sample_.bytes += encoded_bytes(response.points());
  sample_.blocks.push_back(std::move(*response.mutable_points()));
}

absl::StatusOr<EncodedSample> SampleGatherer::take(const v1::SampleRequest& request) && {
  const std::uint64_t most = most_points(request);
  if (points_ == 0 || points_ > most || (points_ < most && is_exact(request))) {
    return absl::DataLossError(
        absl::StrCat("asked for ", most, " points", is_exact(request) ? "" : " at most", ", but the server sent ", points_));
  }
  return std::move(sample_);
}

absl::StatusOr<DecodedSample> decode_sample(const EncodedSample& sample) {
  DecodedSample decoded{.points = {}, .statistics = sample.statistics, .bytes = sample.bytes};
  for (const v1::PointBlock& block : sample.blocks) {
    absl::StatusOr<Points> points = decode_block(block);
    if (!points.ok()) return points.status();
    if (decoded.points.size() > 0 && points->size() > 0 && !have_same_columns(decoded.points, *points)) {
      return absl::DataLossError("the server sent blocks of which not all have the same attributes");
    }
    append_points(*std::move(points), &decoded.points);
  }
  return decoded;
}

}  // namespace curvecast::client
