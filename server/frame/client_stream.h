// One conversation of views and frames, whatever carries it: knows the protocol's messages but no transport.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/mutex.h"
#include "server/frame/frame_pace.h"
#include "server/frame/make_frame.h"
#include "server/frame/send_window.h"
#include "server/frame/stream_state.h"

namespace curvecast::server {

/// Answers the newest view: views that were overtaken are dropped. One view waits, for a worker too, one is being answered, at
/// most two frames are unacknowledged. stream_state.h has the states that a stream goes through.
///
/// Thread-safe. Held by shared_ptr, because jobs may outlive the transport. All functions may be called by any thread, not by the
/// transport or by a hook that is called with the lock held.
class ClientStream : public std::enable_shared_from_this<ClientStream> {
 public:
  /// Called with the stream's lock held, so it must not call the stream back on the same thread.
  class Transport {
   public:
    virtual ~Transport() = default;
    /// Sends one message at a time: send() is not called again before the transport has called sent().
    virtual void send(v1::StreamViewsResponse response) = 0;
    /// Ends the stream. This is the last call, and never comes while a message is being sent. The transport may go away at once.
    virtual void end(const absl::Status& status) = 0;
  };

  struct Hooks {
    /// Finds the session to open. Called with the lock held.
    std::function<absl::StatusOr<std::shared_ptr<const Session>>(const std::string& session_id)> find;
    /// Answers a view. Called without the lock, on a worker. DataLoss ends the stream: nothing more comes of its session. An
    /// answer with FollowUp::kAfterImprovement promises that refined() is called after the session's curve and ranks were read
    /// for it.
    std::function<absl::StatusOr<Answer>(const std::shared_ptr<const Session>&, const FrameRequest&)> answer;
    /// Makes the points again that the client says that it has; null where it has others. Called without the lock, on a worker.
    std::function<absl::StatusOr<std::shared_ptr<const ReferenceFrame>>(const Session&, const ResumeClaim&,
                                                                        const ExecutionContext&)>
        restore;
    /// Whether a frame may be made for the client, who may have too many that wait. Called with the lock held. An error refuses a
    /// view as one of submit() does.
    std::function<absl::Status()> has_room;
    /// Has a worker run the job, which will take about as long as is expected, later, never within the call. Called with the
    /// lock held. An error refuses a view that has no frame yet; a better frame of a view is tried again with the next event,
    /// retry() at the latest.
    std::function<absl::Status(std::function<void()> job, std::chrono::nanoseconds expected)> submit;
    /// Counts bytes of frames that are queued or being sent from now on or, below 0, no more. Called with the lock held.
    std::function<void(std::int64_t bytes)> count_queued;
    /// For so long, somebody who came back and looks at what he holds gets no frame of fewer points while others are made;
    /// then he gets one with the next event, retry() at the latest.
    std::chrono::milliseconds patience{500};
  };

  ClientStream(Transport* transport, Hooks hooks);

  void receive(const v1::StreamViewsRequest& request) ABSL_LOCKS_EXCLUDED(mutex_);
  /// The client sends no more: it gets the frames still due, then the end.
  void half_close() ABSL_LOCKS_EXCLUDED(mutex_);
  /// The message has left, or (false) never will.
  void sent(bool ok) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Work on a session's curve or ranks is over, whether anything came of it or not. If the session is this stream's, and the
  /// newest view waits for that, the view is answered again, with the same number; the frame is sent if it has more points than
  /// the one before or a newer curve, or is the view's last one.
  void refined(const Session& session) ABSL_LOCKS_EXCLUDED(mutex_);
  /// A preview gives way to the real session: if it is this stream's, the newest view is answered anew, from a key frame on; or
  /// the stream ends with the reason why there is none.
  void replace(const Session& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Asks for a worker again where the server was too busy to make a better frame, or a frame was kept back for long enough; else
  /// does nothing. To be called now and then, for a client that has all its frames says nothing more.
  void retry() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends the stream once the frame that is being made or sent has left, if there is one; a view that waits is dropped.
  void retire(const absl::Status& reason) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends the stream as soon as no message is being sent; views and frames that wait are dropped.
  void stop(const absl::Status& reason) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  using Clock = SendWindow::Clock;

  /// What the frames of a view have brought so far.
  struct Progress {
    std::uint64_t curve_revision = 0;
    std::uint64_t points = 0;
    std::uint64_t digest = 0;  // of ranked points; else 0
    /// Whether a frame goes beyond this: with as many points of more ranks there are others.
    bool is_surpassed_by(const Progress& later) const {
      return later.curve_revision > curve_revision || later.points > points || (later.points == points && later.digest != digest);
    }
  };

  struct View {
    std::uint64_t sequence = 0;
    absl::StatusOr<PointSetRequest> request;  // converted on arrival, so that what waits is small
    std::uint64_t first_bytes = 0;            // of ViewUpdate
    std::optional<Progress> shown;            // not set: the view has no frame yet
    bool is_in_parts = false;                 // its last frame was a part
    int improvements = 0;                     // how often it was answered again on a finer curve
    int in_vain = 0;                          // how often without getting better: the work was for others, or failed
    Clock::time_point started = {};

    /// Whether a better answer may follow the next one.
    bool may_refine() const;
  };

  // What the client sends.
  void receive_open(const v1::OpenView& request) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void receive_view(const v1::ViewUpdate& update) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Leaves an answer in the making little time: a newer view has come.
  void hurry_answer() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void receive_ack(std::uint64_t sequence) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  /// Ends the stream with `reason`, unless it is ending already.
  void fail(absl::Status reason) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Ends the stream with `reason` if the event leads there.
  void change_link(LinkEvent event, absl::Status reason = absl::OkStatus()) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool is_over() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return link_ == LinkState::kEnding || link_ == LinkState::kEnded; }
  bool is_due() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return wants_worker(link_, view_state_, window_.has_room()); }

  /// Does what is due after an event: asks for a worker, gives the next message to the transport, or ends the stream.
  void dispatch() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// What the view that is due will take of a worker.
  std::chrono::nanoseconds expected_work() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ask_for_worker() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void end_when_idle() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  /// Makes a frame of the view that is due, on a worker.
  void run_worker() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Has a view answered from the start, unless it was overtaken.
  void answer_anew(View view) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  View begin_answer() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void finish_answer(View view, absl::StatusOr<Answer> answer) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Whether an answer to the view that the client holds from another stream is worse than that, for the time being: rather none
  /// yet.
  bool keeps_claimed(const View& view, const Answer& answer) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void refuse_waiting_view(const absl::Status& reason) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Queues a frame: the one place that sets FrameStatistics.refining in a stream.
  void queue_frame(const View& view, absl::StatusOr<Answer> answer) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Transport* const transport_;
  const Hooks hooks_;
  std::atomic<bool> cancel_ = false;  // true: nobody waits for the frame in the making

  Mutex mutex_;
  LinkState link_ ABSL_GUARDED_BY(mutex_) = LinkState::kUnopened;
  std::optional<absl::Status> retired_ ABSL_GUARDED_BY(mutex_);  // why
  absl::Status end_status_ ABSL_GUARDED_BY(mutex_);              // with which the stream ends, from kEnding on
  std::shared_ptr<const Session> session_ ABSL_GUARDED_BY(mutex_);
  bool accepts_deltas_ ABSL_GUARDED_BY(mutex_) = false;

  ViewState view_state_ ABSL_GUARDED_BY(mutex_) = ViewState::kNone;
  std::optional<View> view_ ABSL_GUARDED_BY(mutex_);  // the newest view: in kWaiting, kCoarse and kImprovable
  std::optional<std::uint64_t> newest_sequence_ ABSL_GUARDED_BY(mutex_);
  bool has_worker_ ABSL_GUARDED_BY(mutex_) = false;        // a worker was asked for, or works
  std::optional<WorkLimit> work_ ABSL_GUARDED_BY(mutex_);  // of the answer in the making, or the last one
  bool is_hurried_ ABSL_GUARDED_BY(mutex_) = false;        // that answer had little time left when a newer view came
  bool was_given_up_ ABSL_GUARDED_BY(mutex_) = false;      // the answer before it, for that reason

  std::shared_ptr<const ReferenceFrame> reference_
      ABSL_GUARDED_BY(mutex_);                                // held by the client once it has received all that was queued
  std::optional<ResumeClaim> claim_ ABSL_GUARDED_BY(mutex_);  // what the client holds of another stream; until a frame is queued
  Clock::time_point claimed_ ABSL_GUARDED_BY(mutex_);         // when it said so
  bool wants_key_ ABSL_GUARDED_BY(mutex_) = false;            // until a key frame is queued

  std::chrono::nanoseconds last_work_ ABSL_GUARDED_BY(mutex_){};  // what the last answer took
  FramePace pace_ ABSL_GUARDED_BY(mutex_);
  SendWindow window_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
