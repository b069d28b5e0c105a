// Makes the frame that answers a view: all its points, or the difference to those that the client holds.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>

#include "server/frame/reference_frame.h"
#include "server/frame/session_sampler.h"

namespace curvecast::server {

/// A view to be answered.
struct FrameRequest {
  const PointSetRequest& point_set;
  const ReferenceFrame* reference = nullptr;  // what the client holds, for a delta where that pays; null: a key frame
  std::uint64_t first_bytes = 0;              // above 0: many points come in parts, the first of about so many bytes
  bool may_refine = true;                     // what the frame lacks may be made
  ExecutionContext context = {};              // says when the frame is not wanted any more, and what it may cost
};

/// What can follow a frame of the same view without being asked for.
enum class FollowUp {
  kNone,              // nothing: no better frame is known of
  kNextPart,          // a frame with more points, as soon as the client holds those of this one
  kAfterImprovement,  // a better frame, once a finer curve or more ranked candidates have been made
};

/// The frame that answers a view. Its sequence number and FrameStatistics.refining are left to the caller, who knows whether the
/// follow-up will be sent.
struct Answer {
  v1::PointFrame frame;
  std::shared_ptr<const ReferenceFrame> reference;  // what the client holds after the frame; null: no delta can start from it
  FollowUp follow_up = FollowUp::kNone;
};

/// Makes a frame from the ranked candidates and the curve that there are, and asks for what is lacking. A part has exactly as
/// many points as were asked for: where there are no more, the frame is that of the whole view. Errors as of curvecast::resample;
/// ResourceExhausted for more than kMaxFrameBytes; those of the context as of SessionSampler::open().
absl::StatusOr<Answer> make_frame(const Session& session, const FrameRequest& request, ViewCache& cache,
                                  const ImprovementRequests& improvements);

/// What a client says that it holds of another stream: OpenView.held.
struct ResumeClaim {
  PointSetRequest point_set;
  std::uint64_t points = 0;
  std::uint64_t digest = 0;
};

/// Selects again the points that a client claims to hold; null where their digest is another, or where there are not yet all
/// candidates that it takes. Errors as of SessionSampler::open().
absl::StatusOr<std::shared_ptr<const ReferenceFrame>> restore_reference(const Session& session, const ResumeClaim& claim,
                                                                        ViewCache& cache, const ExecutionContext& context);

}  // namespace curvecast::server
