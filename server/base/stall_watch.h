// Watches over messages that are being sent or waited for, for those that do not get on: their client does nothing.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <utility>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe.
class StallWatch {
 public:
  using Clock = std::chrono::steady_clock;
  /// Ends the call, with this status. Called with the watch's lock held, so it must not call the watch back on the same thread.
  using End = std::function<void(const absl::Status& status)>;

  /// Calls end with `status`.
  explicit StallWatch(absl::Status status) : status_(std::move(status)) {}

  /// A message of `call` is being sent, or waited for, from now on. Precondition: no other one of it is.
  void begin(const void* call, End end) ABSL_LOCKS_EXCLUDED(mutex_);
  /// The message has left or come, or never will. `end` is not called any more once this returns.
  void done(const void* call) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends those whose message was begun before `moment`, each once. Returns how many.
  std::size_t end_begun_before(Clock::time_point moment) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Message {
    Clock::time_point begun;
    End end;  // null: it was called
  };

  const absl::Status status_;
  Mutex mutex_;
  std::map<const void*, Message> messages_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
