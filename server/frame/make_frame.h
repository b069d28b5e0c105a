// Answers the views of a stream: all points, or the difference to those that its client holds.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <memory>

#include "server/frame/held_points.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

inline constexpr std::size_t kMaxFrameBytes = std::size_t{32} << 20;

/// A view to be answered.
struct FrameRequest {
  const Sample& sample;
  const HeldPoints* held = nullptr;           // what the client has, for a delta where that pays; null: a key frame
  std::uint64_t first_bytes = 0;              // above 0: more come in parts, the first of about so many bytes
  bool may_refine = true;                     // what it lacks may be made
  const std::atomic<bool>* cancel = nullptr;  // set by anyone: the frame is not wanted any more; may be null
};

/// What can follow a frame of the same view without being asked for.
enum class FollowUp {
  kNone,              // nothing: no better frame is known of
  kNextPart,          // a frame with more points, as soon as the client holds those of this one
  kAfterImprovement,  // a better frame, once a finer curve or more ranked candidates have been made
};

/// An answer to a view, and what its client holds then: null where that is no use for the next frame.
struct Answer {
  v1::PointFrame frame;
  std::shared_ptr<const HeldPoints> held;
  FollowUp follow_up = FollowUp::kNone;
};

/// The sequence number and FrameStatistics.refining are left to the caller, who knows whether the follow-up will be sent. Does
/// with the ranked candidates that there are. Errors as of curvecast::resample, ResourceExhausted for more than kMaxFrameBytes,
/// and Cancelled.
absl::StatusOr<Answer> make_frame(const Session& session, const FrameRequest& request, ViewCache& cache, const OnShort& on_short);

/// What a client says that it has of another stream.
struct HeldClaim {
  Sample sample;
  std::uint64_t points = 0;
  std::uint64_t digest = 0;
};

/// The points that a client claims to have, made again; null where they turn out to be others. Waits for ranked candidates.
absl::StatusOr<std::shared_ptr<const HeldPoints>> restore_held(const Session& session, const HeldClaim& claim, ViewCache& cache);

}  // namespace curvecast::server
