// Samples a session's curve and packs the points into messages.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <functional>
#include <memory>

#include "server/convert.h"
#include "server/held_points.h"
#include "server/session_sampler.h"

namespace curvecast::server {

inline constexpr std::size_t kBlockPoints = std::size_t{1} << 16;  // of a ResampleResponse: under 2 MiB even as raw floats
inline constexpr std::size_t kMaxFrameBytes = std::size_t{32} << 20;

/// All points as blocks of kBlockPoints, in order, each handed to `emit` as soon as it is packed, or, within a budget of bytes,
/// once all are; the last one carries the statistics. Waits for ranked candidates to be made. Stops with Cancelled when `emit`
/// returns false, or when `cancel` (may be null) is set. Errors as of curvecast::resample, and ResourceExhausted where a single
/// point is too much.
absl::Status make_blocks(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short,
                         const std::atomic<bool>* cancel, const std::function<bool(v1::ResampleResponse)>& emit);

/// An answer to a view, and what its client holds then: null where that is no use for the next frame.
struct Answer {
  v1::PointFrame frame;
  std::shared_ptr<const HeldPoints> held;
};

/// All points in one frame; its sequence number is left to the caller. Does with the ranked candidates that there are. `held`:
/// what the client has, for a delta where that pays; null for a key frame. Errors as of curvecast::resample, and
/// ResourceExhausted for more than kMaxFrameBytes.
absl::StatusOr<Answer> make_frame(const Session& session, const Sample& sample, const HeldPoints* held, ViewCache& cache,
                                  const OnShort& on_short);

}  // namespace curvecast::server
