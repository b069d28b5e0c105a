// A client stream whose transport, jobs and answers are in the test's hands.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/frame/client_stream.h"

namespace curvecast::server {

inline v1::StreamViewsRequest open_request(const std::string& id) {
  v1::StreamViewsRequest request;
  request.mutable_open()->set_session_id(id);
  return request;
}

inline v1::StreamViewsRequest view_request(std::uint64_t sequence, std::uint64_t points = 10) {
  v1::StreamViewsRequest request;
  request.mutable_view()->set_sequence(sequence);
  request.mutable_view()->mutable_sample()->set_points(points);
  return request;
}

inline v1::StreamViewsRequest ack_request(std::uint64_t sequence) {
  v1::StreamViewsRequest request;
  request.mutable_ack()->set_sequence(sequence);
  return request;
}

// Jobs wait until the test runs them; messages leave at once unless `slow_`.
class Conversation : public ClientStream::Transport {
 public:
  void send(v1::StreamViewsResponse response) override {
    EXPECT_FALSE(ended_) << "a frame after the end";
    EXPECT_FALSE(sending_) << "two frames at a time";
    sending_ = true;
    frames_.push_back(response.frame());
  }
  void end(const absl::Status& status) override {
    EXPECT_FALSE(ended_) << "ended twice";
    EXPECT_FALSE(sending_) << "ended while sending";
    ended_ = status;
  }

  void receive(const v1::StreamViewsRequest& request) {
    stream_->receive(request);
    deliver();
  }
  void run_job() {
    ASSERT_FALSE(jobs_.empty());
    auto job = std::move(jobs_.front());
    jobs_.pop_front();
    job();
    deliver();
  }
  void run_all() {
    while (!jobs_.empty()) run_job();
  }
  void deliver() {
    while (sending_ && !slow_) {
      sending_ = false;
      stream_->sent(true);
    }
  }
  std::vector<std::uint64_t> sequences() const {
    std::vector<std::uint64_t> out;
    for (const auto& frame : frames_) out.push_back(frame.sequence());
    return out;
  }

  std::deque<std::function<void()>> jobs_;
  std::chrono::nanoseconds expected_{};  // of the last one
  std::vector<v1::PointFrame> frames_;
  std::optional<absl::Status> ended_;
  bool sending_ = false, slow_ = false, busy_ = false;
  bool is_full_ = false;  // with frames that wait
  std::shared_ptr<const Session> session_ = std::make_shared<const Session>();
  std::uint64_t revision_ = 1;
  bool fails_ = false;                                             // no view can be answered
  bool lacks_ = false;                                             // what a client claims to hold is not there yet
  bool short_ = false;                                             // the curve is too coarse for every view
  std::uint64_t shown_ = 0;                                        // points that a frame says that there are
  std::vector<const ReferenceFrame*> given_;                       // what the client was said to hold, answer by answer
  std::vector<std::shared_ptr<const ReferenceFrame>> references_;  // and what it holds with the answer
  std::function<void()> on_answer_;                                // while a view is being answered
  bool is_answered_ = false;                                       // for on_answer_ to set
  ExecutionContext context_;                                       // of that
  std::int64_t queued_bytes_ = 0;
  int parts_ = 0;                                   // before the whole, of views that may come in parts
  bool stuck_ = false;                              // parts bring no points beyond those of the one before
  static constexpr std::uint64_t kKnownDigest = 7;  // what a client may claim to have
  std::vector<std::uint64_t> claims_;
  std::shared_ptr<const ReferenceFrame> restored_ = std::make_shared<const ReferenceFrame>();
  ClientStream::Hooks hooks_ = {
      .find = [this](const std::string& id) -> absl::StatusOr<std::shared_ptr<const Session>> {
        if (id != "known") return absl::NotFoundError("no such session");
        return session_;
      },
      .answer = [this](const std::shared_ptr<const Session>&, const FrameRequest& request) -> absl::StatusOr<Answer> {
        const std::uint64_t points = request.point_set.options.points;
        if (points == 99) return absl::OutOfRangeError("99 is too many");
        if (points == 98) throw std::runtime_error("98");
        if (fails_) return absl::ResourceExhaustedError("too large");
        Answer answer;
        v1::PointFrame& frame = answer.frame;
        frame.set_kind(request.reference != nullptr ? v1::FRAME_KIND_DELTA : v1::FRAME_KIND_KEY);
        given_.push_back(request.reference);
        if (request.point_set.sampler == Sampler::kProgressive) answer.reference = std::make_shared<const ReferenceFrame>();
        references_.push_back(answer.reference);
        frame.add_points()->set_count(static_cast<std::uint32_t>(points));
        frame.set_curve_revision(revision_);
        if (request.first_bytes > 0 && !stuck_) shown_ += points;
        frame.set_held_points(shown_);
        if (short_ && request.may_refine) answer.follow_up = FollowUp::kAfterImprovement;
        if (request.first_bytes > 0 && parts_-- > 0) answer.follow_up = FollowUp::kNextPart;
        context_ = request.context;
        if (on_answer_) on_answer_();
        if (const absl::Status left = context_.check_limit(); absl::IsDeadlineExceeded(left)) return left;
        return answer;
      },
      .restore = [this](const Session&, const ResumeClaim& claim,
                        const ExecutionContext&) -> absl::StatusOr<std::shared_ptr<const ReferenceFrame>> {
        if (claim.digest == 98) throw std::runtime_error("98");
        claims_.push_back(claim.digest);
        return claim.digest == kKnownDigest && !lacks_ ? restored_ : nullptr;
      },
      .has_room = [this]() -> absl::Status { return is_full_ ? absl::ResourceExhaustedError("full") : absl::OkStatus(); },
      .submit = [this](std::function<void()> job, std::chrono::nanoseconds expected) -> absl::Status {
        expected_ = expected;
        if (busy_) return absl::ResourceExhaustedError("busy");
        jobs_.push_back(std::move(job));
        return absl::OkStatus();
      },
      .count_queued = [this](std::int64_t bytes) { queued_bytes_ += bytes; },
      .patience = std::chrono::hours(1),
  };
  std::shared_ptr<ClientStream> stream_ = std::make_shared<ClientStream>(this, hooks_);
};

}  // namespace curvecast::server
