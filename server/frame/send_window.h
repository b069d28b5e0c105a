// The frames of a stream between their making and the client's acknowledgement.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "curvecast/v1/curvecast.pb.h"
#include "server/base/protocol.h"
#include "server/convert/point_set_request.h"

namespace curvecast::server {

/// Gives one frame at a time to the transport, and bounds how many the client has not acknowledged. Frames with an error count as
/// frames. Not thread-safe.
class SendWindow {
 public:
  using Clock = std::chrono::steady_clock;

  struct Frame {
    std::uint64_t sequence = 0;
    std::optional<AutomaticBudget>
        automatic;              // set: the time from `started` to the acknowledgement tells how many points keep up
    std::uint64_t points = 0;   // asked for
    Clock::time_point started;  // when its making began
  };

  /// `count_queued` is called with the bytes that are queued or being sent from now on or, below 0, no more.
  explicit SendWindow(std::function<void(std::int64_t bytes)> count_queued) : count_queued_(std::move(count_queued)) {}
  SendWindow(const SendWindow&) = delete;
  SendWindow& operator=(const SendWindow&) = delete;
  ~SendWindow() { count_queued_(-queued_bytes_ - sending_bytes_); }

  /// Whether one more frame may be made before the client acknowledges one.
  bool has_room() const { return unacknowledged_.size() < kMaxFramesInFlight; }
  bool is_sending() const { return is_sending_; }
  bool has_queued() const { return !queue_.empty(); }

  void push(const Frame& frame, v1::StreamViewsResponse response);
  /// Precondition: has_queued(), not is_sending().
  v1::StreamViewsResponse begin_send();
  /// The message has left, or never will.
  void end_send();
  /// Drops the frames that are queued.
  void clear();
  /// Frees the places of the frames sent whose sequence is at most this one, each handed to `on_frame`. False: no frame sent so
  /// far has that sequence or a later one.
  bool acknowledge(std::uint64_t sequence, const std::function<void(const Frame& frame)>& on_frame);

 private:
  const std::function<void(std::int64_t bytes)> count_queued_;
  std::deque<v1::StreamViewsResponse> queue_;
  bool is_sending_ = false;
  std::int64_t queued_bytes_ = 0, sending_bytes_ = 0;
  std::deque<Frame> unacknowledged_;        // sequences never descend; the last queue_.size() frames have not been sent
  std::optional<std::uint64_t> last_sent_;  // sequence of the newest frame given to the transport
};

}  // namespace curvecast::server
