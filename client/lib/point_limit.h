// How many points an answer may have.
#pragma once

#include <algorithm>
#include <cstdint>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// At most; with a budget of pixels or bytes, as many as the API ever sends.
inline std::uint64_t most_points(const v1::SampleRequest& sample) {
  constexpr std::uint64_t kMost = 4'000'000;
  return sample.has_points() ? sample.points() : kMost;
}

/// Whether it has to be exactly most_points(). Of the progressive sampler there may be fewer: see the API.
inline bool is_exact(const v1::SampleRequest& sample) {
  if (sample.sampler() == v1::SAMPLER_PROGRESSIVE) return false;
  const auto lowers = [](const v1::DensityTerm& term) { return term.distance().global(); };
  return sample.has_points() && std::none_of(sample.density().begin(), sample.density().end(), lowers);
}

}  // namespace curvecast::client
