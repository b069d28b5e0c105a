// One conversation of views and frames, whatever carries it: knows the protocol's messages but no transport.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/frame/frame_pace.h"
#include "server/frame/make_frame.h"

namespace curvecast::server {

/// Thread-safe. The newest view wins: one waits, for a worker too, one is being answered, at most two frames are unacknowledged.
/// Frames with an error count as frames. Held by shared_ptr, because jobs may outlive the transport.
class ClientStream : public std::enable_shared_from_this<ClientStream> {
 public:
  /// Called with the stream's lock held, so it must not call the stream back on the same thread.
  class Transport {
   public:
    virtual ~Transport() = default;
    /// One at a time: not again before sent().
    virtual void send(v1::StreamViewsResponse response) = 0;
    /// The last call, and never while a message is being sent. The transport may go away at once.
    virtual void end(const absl::Status& status) = 0;
  };

  struct Hooks {
    /// The session to open. Called with the lock held.
    std::function<absl::StatusOr<std::shared_ptr<const Session>>(const std::string& session_id)> find;
    /// Answers a view, without the lock, on a worker. A frame whose statistics say that the curve is being refined is a promise
    /// that refined() follows, after the curve was taken; unless it is a part.
    std::function<absl::StatusOr<Answer>(const std::shared_ptr<const Session>&, const FrameRequest&)> answer;
    /// What the client says that it has; null where that is not so. Without the lock, on a worker.
    std::function<absl::StatusOr<std::shared_ptr<const HeldPoints>>(const Session&, const HeldClaim&)> restore;
    /// Has a worker run the job later, never within the call. An error refuses the newest view.
    std::function<absl::Status(std::function<void()> job)> submit;
    /// Told of bytes of frames that wait to be sent, or are being sent, from then on or (below 0) no more. Called with the lock
    /// held.
    std::function<void(std::int64_t bytes)> count_queued;
  };

  ClientStream(Transport* transport, Hooks hooks);
  ~ClientStream();

  void receive(const v1::StreamViewsRequest& request);
  /// The client sends no more: it gets the frames still due, then the end.
  void half_close();
  /// The message has left, or never will.
  void sent(bool ok);
  /// A refinement of a session's curve is over: if it is this stream's session and the newest view found the curve too coarse,
  /// that view is answered again, with the same number. Its frames count like others.
  void refined(const Session& session);
  /// Ends the stream as soon as no message is being sent; later and waiting views are dropped.
  void stop(const absl::Status& reason);

 private:
  using Clock = std::chrono::steady_clock;

  struct View {
    std::uint64_t sequence = 0;
    absl::StatusOr<Sample> sample;  // converted on arrival, so that what waits is small
    std::uint64_t first_bytes = 0;  // of ViewUpdate
    int improvements = 0;           // how often it was answered again
    Clock::time_point started = {};
  };
  /// A frame computed. One with an automatic budget tells, when it is acknowledged, how long it took.
  struct Unacknowledged {
    std::uint64_t sequence;
    std::optional<AutomaticBudget> automatic;
    std::uint64_t points = 0;
    Clock::time_point started = {};
  };

  void open(const v1::OpenView& request);
  void view(const v1::ViewUpdate& update);
  void acknowledge(std::uint64_t sequence);
  /// Whether the newest view, or the same one again, is to be answered now.
  bool is_due() const;
  void ask_for_worker();
  /// Answers the view that is due, on a worker.
  void work();
  View take_due();
  /// Without the lock.
  absl::StatusOr<Answer> answer(const std::shared_ptr<const Session>& session, const View& view,
                                std::shared_ptr<const HeldPoints> held, const std::optional<HeldClaim>& claim) const;
  void settle(View view, absl::StatusOr<Answer> answer);
  void queue_frame(const View& view, absl::StatusOr<Answer> answer);
  void advance();

  Transport* const transport_;
  const Hooks hooks_;
  std::mutex mutex_;
  std::shared_ptr<const Session> session_;
  bool accepts_deltas_ = false;             // does not change once there is a session
  bool wants_key_ = false;                  // until one is queued
  std::shared_ptr<const HeldPoints> held_;  // by the client, once it has taken in all that was queued
  std::optional<HeldClaim> claim_;          // what it has of another stream; until a frame is queued
  FramePace pace_;
  std::optional<View> pending_;
  bool computing_ = false;                      // or waiting for a worker
  std::optional<View> coarse_;                  // answered, but from a curve that is being refined; newer views replace it
  std::uint64_t coarse_revision_ = 0;           // of the curve that it was answered from
  std::uint64_t coarse_points_ = 0;             // that it was answered with
  bool refined_ = false;                        // since the newest answer was begun
  std::deque<v1::StreamViewsResponse> outbox_;  // waits for the transport
  bool sending_ = false;
  std::int64_t queued_bytes_ = 0, sending_bytes_ = 0;  // of the outbox; of the message being sent
  std::deque<Unacknowledged> unacknowledged_;  // frames computed, never descending; the last outbox_.size() have not been sent
  std::optional<std::uint64_t> last_view_;     // numbers of the newest view received
  std::optional<std::uint64_t> last_sent_;     // and of the newest frame given to the transport
  bool half_closed_ = false;
  std::optional<absl::Status> ending_;  // set: ends with it as soon as the transport is free
  std::atomic<bool> cancel_ = false;    // then: nobody waits for the frame in the making
  bool ended_ = false;
};

}  // namespace curvecast::server
