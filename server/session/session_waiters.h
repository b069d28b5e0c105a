// Those who wait for a session that is being made, and what they are told.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/mutex.h"
#include "server/session/session.h"

namespace curvecast::server {

/// Waits for a session. Called without locks, from any thread, one call at a time. May call the store, but no
/// SessionStore::leave() for itself within a call.
class SessionWaiter {
 public:
  virtual ~SessionWaiter() = default;
  /// The start and the end of every stage and, about 20 times a second, what lies between. `fraction` is in [0, 1].
  virtual void on_progress(std::string_view stage, double fraction) = 0;
  /// Whether a stand-in is of use. The same all the time; called with locks.
  virtual bool wants_preview() const { return false; }
  /// Once at most: there is a stand-in to look at. Also called where another waiter wanted it.
  virtual void on_preview(const std::shared_ptr<const Session>& /*preview*/) {}
  /// The last call: the session is ready, or why it never will be.
  virtual void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) = 0;
};

/// Thread-safe. Everything but deliver() only queues calls, so that it can be called with locks held; each is to be followed by
/// deliver(), which makes the calls, without. Waiters must live until remove() or their on_done.
class SessionWaiters {
 public:
  /// The waiter is told the newest progress and of the preview, if there is one, and from then on everything.
  void add(SessionWaiter* waiter);
  /// The waiter is not called any more when this returns, which waits for a call to it under way. False where its on_done has
  /// been called, or it was never added.
  bool remove(SessionWaiter* waiter) ABSL_LOCKS_EXCLUDED(mutex_);
  bool empty() const;
  /// Whether any of those who wait wants a stand-in.
  bool want_preview() const;
  /// A stage that a new one follows counts as finished. Calls come as of SessionWaiter::on_progress, however often this is
  /// called.
  void progress(std::string_view stage, double fraction);
  /// Tells of a stand-in.
  void preview(std::shared_ptr<const Session> preview);
  /// Ends it for all who wait; later progress is ignored.
  void finish(const absl::StatusOr<std::shared_ptr<const Session>>& result);
  /// Makes the calls that are queued, but for those to waiters that another thread is calling: it makes these.
  void deliver() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  using Clock = std::chrono::steady_clock;
  using Result = absl::StatusOr<std::shared_ptr<const Session>>;
  struct Call {
    std::string stage;
    double fraction = 0;
    std::shared_ptr<const Session> preview = nullptr;  // set: on_preview
    std::optional<Result> result = {};                 // set: on_done
  };
  struct Recipient {
    SessionWaiter* waiter;
    std::deque<Call> calls = {};
    bool is_being_called = false;
  };

  void broadcast(std::string_view stage, double fraction) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable Mutex mutex_;
  CondVar call_over_;
  std::vector<std::shared_ptr<Recipient>> recipients_ ABSL_GUARDED_BY(mutex_);  // those whose on_done has not been called
  bool is_finished_ ABSL_GUARDED_BY(mutex_) = false;
  std::shared_ptr<const Session> preview_ ABSL_GUARDED_BY(mutex_);
  // Told last.
  std::string stage_ ABSL_GUARDED_BY(mutex_) = "queued";
  double fraction_ ABSL_GUARDED_BY(mutex_) = 0;
  Clock::time_point told_at_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
