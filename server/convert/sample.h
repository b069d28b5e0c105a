// What a client wants of a point set.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/codec/draco_codec.h"
#include "core/sample/resample.h"

namespace curvecast::server {

/// Which sampler places the points: see resample() and sample_ranked().
enum class Sampler { kEqualised, kProgressive };

/// More of each point.
struct PointAttributes {
  bool curvatures = false;
  bool rank = false;
  bool surface = false;

  bool operator==(const PointAttributes&) const = default;
};

/// As many points as keep up with the camera: see FramePace.
struct AutomaticBudget {
  double frame_seconds = 0.1;
  std::uint64_t max_points = 200'000;
};

/// What a client asked for in a SampleRequest, checked as far as that goes without the session.
struct Sample {
  Sampler sampler = Sampler::kEqualised;
  PointAttributes attributes;
  ResampleOptions options;                     // `points` as asked for; not used with one of the other budgets
  double pixel_error = 0;                      // above 0: instead of a number of points
  std::uint64_t max_bytes = 0;                 // above 0: instead of a number of points
  std::optional<AutomaticBudget> automatic;    // set: instead of a number of points
  std::optional<DracoOptions> draco;           // bits only; the lattice is the session's. Not set: raw floats
  std::array<std::uint64_t, 2> fingerprint{};  // the same for the same request
};

}  // namespace curvecast::server
