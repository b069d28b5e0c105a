// SPDX-License-Identifier: Apache-2.0
// Point sets as they come over the wire.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "points.h"

namespace curvecast::client {

struct EncodedSample {
  std::vector<v1::PointBlock> blocks;  // consecutive along the curve, N points together
  v1::FrameStatistics statistics;
  std::uint64_t bytes = 0;  // of the encoded points
};

struct DecodedSample {
  Points points;  // N
  v1::FrameStatistics statistics;
  std::uint64_t bytes = 0;  // of the encoded points
};

/// The largest number of points that may come: with a budget of pixels or bytes, as many as the API ever sends.
std::uint64_t most_points(const v1::SampleRequest& sample);
/// Whether exactly most_points() points have to come. The progressive sampler may have fewer: see the API.
bool is_exact(const v1::SampleRequest& sample);

/// Joins the messages of an answer with points.
class SampleGatherer {
 public:
  void add(v1::ResampleResponse& response);
  /// What was added. DataLoss where that is not what `request` asked for.
  absl::StatusOr<EncodedSample> take(const v1::SampleRequest& request) &&;

 private:
  EncodedSample sample_;
  std::uint64_t points_ = 0;
};

/// Decodes the blocks and joins them.
absl::StatusOr<DecodedSample> decode_sample(const EncodedSample& sample);

}  // namespace curvecast::client
