// Watches over messages that are being sent, for those that do not get on: their client does not read.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe.
class SendWatch {
 public:
  using Clock = std::chrono::steady_clock;
  /// Ends the call that sends, with this status. Called with the watch's lock held, so it must not call the watch back on the
  /// same thread.
  using End = std::function<void(const absl::Status& status)>;

  /// A message of `sender` is being sent from now on. Precondition: no other one of it is.
  void begin(const void* sender, End end) ABSL_LOCKS_EXCLUDED(mutex_);
  /// The message has left, or never will. `end` is not called any more once this returns.
  void done(const void* sender) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends those whose message has been being sent since before `moment`, each once. Returns how many.
  std::size_t end_begun_before(Clock::time_point moment) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Send {
    Clock::time_point begun;
    End end;  // null: it was called
  };

  Mutex mutex_;
  std::map<const void*, Send> sends_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
