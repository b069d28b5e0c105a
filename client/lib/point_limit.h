// SPDX-License-Identifier: Apache-2.0
// How many points an answer to a request may have.
#pragma once

#include <algorithm>
#include <cstdint>

#include "client/lib/protocol.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// The largest number of points that may come: with a budget of pixels or bytes, as many as the API ever sends.
inline std::uint64_t most_points(const v1::SampleRequest& sample) { return sample.has_points() ? sample.points() : kMaxPoints; }

/// Whether exactly most_points() points have to come. The progressive sampler may have fewer: see the API.
inline bool is_exact(const v1::SampleRequest& sample) {
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE) return false;
  const auto lowers = [](const v1::DensityTerm& term) { return term.distance().global(); };
  return sample.has_points() && std::none_of(sample.density().begin(), sample.density().end(), lowers);
}

}  // namespace curvecast::client
