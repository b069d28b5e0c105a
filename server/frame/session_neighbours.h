// Finds the neighbours of the points of a session that one request asks for.
#pragma once

#include <absl/status/status.h>

#include <functional>

#include "server/convert/neighbour_chunks.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// Samples the session as `request` says, hands the points to `emit` as make_point_blocks() does, then the neighbours of every
/// point. Progress is that of list_nearest(). Waits for ranked candidates to be made. Errors as of SessionSampler; OutOfRange for
/// more than kMaxNeighbourPairs neighbours; Cancelled, also where `emit` returned false.
absl::Status find_neighbours(const Session& session, const PointSetRequest& request, const NeighbourSearch& search,
                             ViewCache& cache, const ImprovementRequests& improvements, const ExecutionContext& context,
                             const NeighbourChunks::Emit& emit);

}  // namespace curvecast::server
