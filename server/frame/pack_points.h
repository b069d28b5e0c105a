// Points of a view, encoded in blocks.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// What a point takes, roughly; neighbours differ little, so that about half of a position's bits are left.
double expected_point_bytes(const SurfaceCurve& curve, const Sample& sample);
/// Exactly, where points are raw and have no further attributes.
std::size_t raw_point_bytes(const SurfaceCurve& curve);

struct Packed {
  Sampled sampled;
  std::vector<v1::PointBlock> blocks;
  std::size_t bytes = 0;  // of their data
};

/// Points fill as few blocks as it takes for none to have more than so many, all of about equal length. Small enough that the
/// cores of both sides have one each.
inline constexpr std::size_t kBlockPoints = 12'500;
inline std::size_t block_count(std::size_t points) { return (points + kBlockPoints - 1) / kBlockPoints; }

/// Blocks [first, last) of all, several encoded at once; adds the time that it takes to the statistics.
absl::StatusOr<std::vector<v1::PointBlock>> encode_blocks(Sampled& sampled, std::size_t first, std::size_t last,
                                                          const Sample& sample);

/// All points. One block without any where there are none.
absl::StatusOr<Packed> pack(Sampled sampled, const Sample& sample);

/// As many points as `limit` bytes hold. ResourceExhausted where a single one is too much.
absl::StatusOr<Packed> pack_within(SessionSampler& sampler, const Sample& sample, double limit);

/// Asks for what a view lacks. Returns whether that is being made.
bool ask_for_better(const Sampled& sampled, const OnShort& on_short);

}  // namespace curvecast::server
