// Answers Resample: samples a session's curve once and packs the points into messages.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// Hands `points` points to `emit`, in blocks and in order, each as soon as it is packed: `encode` makes blocks [first, last).
/// The last message carries `statistics`, as they are then; its `refining` is `is_improving`. Cancelled: `emit` returned false.
absl::Status emit_blocks(
    std::size_t points,
    const std::function<absl::StatusOr<std::vector<v1::PointBlock>>(std::size_t first, std::size_t last)>& encode,
    const PointSetStatistics& statistics, bool is_improving, const std::function<bool(v1::ResampleResponse)>& emit);

/// Hands sampled points to `emit`, in blocks and in order, each as soon as it is packed. The last message carries the statistics;
/// its `refining` is `is_improving`. Cancelled: `emit` returned false.
absl::Status emit_point_blocks(Sampled& sampled, const PointSetRequest& request, bool is_improving,
                               const std::function<bool(v1::ResampleResponse)>& emit);

/// Hands all points to `emit`, in blocks and in order: each as soon as it is packed or, for a budget of bytes, once all are. The
/// last message carries the statistics; its `refining` says that what the points lack is being made, so that a later request gets
/// better ones. Waits for ranked candidates to be made. Cancelled: `emit` returned false, or `context` is cancelled.
/// Errors as of SessionSampler::open(); ResourceExhausted where a single point takes more than the budget of bytes.
absl::Status make_point_blocks(const Session& session, const PointSetRequest& request, ViewCache& cache,
                               const ImprovementRequests& improvements, const ExecutionContext& context,
                               const std::function<bool(v1::ResampleResponse)>& emit);

}  // namespace curvecast::server
