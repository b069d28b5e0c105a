// Ends what may go on for long, once its caller may call no more.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <functional>
#include <map>

#include "core/base/mutex.h"
#include "server/engine/caller.h"

namespace curvecast::server {

/// Thread-safe.
class CallerWatch {
 public:
  using Check = std::function<absl::Status(const Caller& caller)>;
  /// Ends something, for that reason; may come when it is gone, and again.
  using End = std::function<void(const absl::Status& why)>;

  /// `check` tells whether a caller still may call. Called without the watch's lock.
  explicit CallerWatch(Check check) : check_(std::move(check)) {}

  /// What is watched until it is destroyed.
  class Ticket {
   public:
    Ticket(CallerWatch& watch, const Caller& caller, End end);
    Ticket(const Ticket&) = delete;
    Ticket& operator=(const Ticket&) = delete;
    ~Ticket();

   private:
    CallerWatch& watch_;
    std::uint64_t number_;
  };

  /// Ends what callers have who may call no more, the newest first: a stream is told before the socket goes that it came over.
  void end_refused() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Watched {
    Caller caller;
    End end;
  };

  const Check check_;
  Mutex mutex_;
  std::uint64_t last_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::uint64_t, Watched> watched_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
