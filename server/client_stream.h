// One conversation of views and frames, whatever carries it: knows the protocol's messages but no transport.
#pragma once

#include <absl/status/statusor.h>

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/point_blocks.h"

namespace curvecast::server {

/// Thread-safe. The newest view wins: one view waits, one is being answered, at most two frames are unacknowledged. Frames with
/// an error count as frames. Held by shared_ptr, because jobs may outlive the transport.
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
    /// that refined() follows, after the curve was taken. `held`: what the client will have by then, or null: for a key frame.
    std::function<absl::StatusOr<Answer>(const std::shared_ptr<const Session>&, const Sample&, const HeldPoints* held,
                                         bool may_refine)>
        answer;
    /// Has a worker run the job later, never within the call. An error refuses the view.
    std::function<absl::Status(std::function<void()> job)> submit;
  };

  ClientStream(Transport* transport, Hooks hooks);

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
  struct View {
    std::uint64_t sequence = 0;
    absl::StatusOr<Sample> sample;  // converted on arrival, so that what waits is small
    int improvements = 0;           // how often it was answered again
  };

  void open(const v1::OpenView& request);
  void view(const v1::ViewUpdate& update);
  void acknowledge(std::uint64_t sequence);
  void start(View next);
  void settle(View view, absl::StatusOr<Answer> answer);
  void queue_frame(std::uint64_t sequence, absl::StatusOr<Answer> answer);
  void advance();

  Transport* const transport_;
  const Hooks hooks_;
  std::mutex mutex_;
  std::shared_ptr<const Session> session_;
  bool accepts_deltas_ = false;
  bool wants_key_ = false;                  // until one is queued
  std::shared_ptr<const HeldPoints> held_;  // by the client, once it has taken in all that was queued
  std::optional<View> pending_;
  bool computing_ = false;
  std::optional<View> coarse_;                  // answered, but from a curve that is being refined; newer views replace it
  std::uint64_t coarse_revision_ = 0;           // of the curve that it was answered from
  bool refined_ = false;                        // since the newest answer was begun
  std::deque<v1::StreamViewsResponse> outbox_;  // waits for the transport
  bool sending_ = false;
  std::deque<std::uint64_t> unacknowledged_;  // frames computed, never descending; the last outbox_.size() have not been sent
  std::optional<std::uint64_t> last_view_;    // numbers of the newest view received
  std::optional<std::uint64_t> last_sent_;    // and of the newest frame given to the transport
  bool half_closed_ = false;
  std::optional<absl::Status> ending_;  // set: ends with it as soon as the transport is free
  bool ended_ = false;
};

}  // namespace curvecast::server
