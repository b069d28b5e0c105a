// Samples a session's curve once and packs the points into messages.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <functional>

#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// All points in blocks, in order, handed to `emit` as soon as they are packed, or, within a budget of bytes,
/// once all are; the last one carries the statistics. Waits for ranked candidates to be made. Stops with Cancelled when `emit`
/// returns false, or when `cancel` (may be null) is set. Errors as of curvecast::resample, and ResourceExhausted where a single
/// point is too much.
absl::Status make_blocks(const Session& session, const Sample& sample, ViewCache& cache, const OnShort& on_short,
                         const std::atomic<bool>* cancel, const std::function<bool(v1::ResampleResponse)>& emit);

}  // namespace curvecast::server
