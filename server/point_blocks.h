// Samples a session's curve and packs the points into messages.
#pragma once

#include <absl/status/statusor.h>

#include <functional>

#include "core/density/fixed_density_cache.h"
#include "server/convert.h"
#include "server/workspaces.h"

namespace curvecast::server {

inline constexpr std::size_t kBlockPoints = std::size_t{1} << 16;  // of a ResampleResponse: under 2 MiB even as raw floats
inline constexpr std::size_t kMaxFrameBytes = std::size_t{32} << 20;

/// Told that the session's curve, of this revision, was too coarse for a sample: whether a finer one is being made.
using OnShort = std::function<bool(const SurfaceCurve& curve)>;

/// What views have in common, so that none makes it anew. Thread-safe.
struct ViewCache {
  FixedDensityCache fixed_densities;
  Workspaces workspaces;
};

/// All points as blocks of kBlockPoints, in order, each handed to `emit` as soon as it is packed; the last one carries the
/// statistics. Stops with Cancelled when `emit` returns false. Errors as of curvecast::resample. `on_short` may be empty.
absl::Status make_blocks(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short,
                         const std::function<bool(v1::ResampleResponse)>& emit);

/// All points in one key frame; its sequence number is left to the caller. Errors as of curvecast::resample, and
/// ResourceExhausted for more than kMaxFrameBytes.
absl::StatusOr<v1::PointFrame> make_frame(const Session& session, const Sample& sample, ViewCache& cache,
                                          const OnShort& on_short);

}  // namespace curvecast::server
