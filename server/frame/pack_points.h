// Packs sampled points into the blocks of a message.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// Estimates the bytes of one encoded point; neighbours differ little, so that about half of a position's bits are left.
/// `position_bits` counts only where the request is not for raw floats.
double expected_point_bytes(const SurfaceCurve& curve, const PointSetRequest& request, int position_bits);
/// Returns the bytes that one point takes at least: what is not compressed of it.
std::size_t least_point_bytes(const SurfaceCurve& curve, const PointSetRequest& request);

struct Packed {
  Sampled sampled;
  std::vector<v1::PointBlock> blocks;
  std::size_t bytes = 0;  // of their data
};

/// A set of points fills as few blocks as it takes for none to have more points than this; all blocks are of about equal length.
/// They are small enough that each core of server and client has one.
inline constexpr std::size_t kMaxPointsOfBlock = 12'500;
inline std::size_t point_block_count(std::size_t points) { return (points + kMaxPointsOfBlock - 1) / kMaxPointsOfBlock; }

/// Encodes blocks [first, last) of point_block_count(points), several at once: `encode` makes that of points [begin, begin +
/// count).
absl::StatusOr<std::vector<v1::PointBlock>> encode_blocks(
    std::size_t points, std::size_t first, std::size_t last,
    const std::function<absl::StatusOr<v1::PointBlock>(std::size_t begin, std::size_t count)>& encode);

/// Encodes blocks [first, last) of point_block_count(sampled.points().size()), several at once, and adds the time to the
/// statistics.
absl::StatusOr<std::vector<v1::PointBlock>> encode_point_blocks(Sampled& sampled, std::size_t first, std::size_t last,
                                                                const PointSetRequest& request);

/// Encodes all points. Where there are none, there is one empty block.
absl::StatusOr<Packed> pack(Sampled sampled, const PointSetRequest& request);

/// Samples and encodes as many points as `limit` bytes hold. ResourceExhausted where a single point takes more.
absl::StatusOr<Packed> pack_within(SessionSampler& sampler, const PointSetRequest& request, double limit);

/// Asks for what a set of points lacks. Returns whether that is being made.
bool request_improvement(const Sampled& sampled, const ImprovementRequests& improvements);

}  // namespace curvecast::server
