// Has sessions saved, one after the other, each again and again until that succeeds.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.h"
#include "server/session/session.h"

namespace curvecast::server {

/// Thread-safe. Sessions that wait are held by copies, which keep what they share from being freed, but not the sessions from
/// being evicted.
class SaveQueue {
 public:
  using Clock = std::chrono::steady_clock;

  /// Called by the queue's thread.
  struct Hooks {
    /// Saves a session. An error that passes by itself, such as a full disk, has it tried again; Cancelled, DataLoss and
    /// InvalidArgument do not. Called without locks.
    std::function<absl::Status(const Session& session)> save;
    /// Removes what was saved of a session that was withdrawn meanwhile. Called with the lock held.
    std::function<void(const std::string& id)> undo;
    /// Tells how a try went, of a session that nobody has withdrawn. Called with the lock held. `is_lost`: it will not be tried
    /// again, nor can it be saved any more.
    std::function<void(const std::string& id, const absl::Status& status, bool is_lost)> on_tried;
  };

  /// After a failure the next try is after `first_wait`, then after twice as long each time, but never more than `longest_wait`.
  explicit SaveQueue(Hooks hooks, Clock::duration first_wait = std::chrono::seconds(1),
                     Clock::duration longest_wait = std::chrono::seconds(10));
  ~SaveQueue();  // stop()
  SaveQueue(const SaveQueue&) = delete;
  SaveQueue& operator=(const SaveQueue&) = delete;

  /// Has a session saved as it will be then, now or after those that wait. Does nothing after stop().
  void put(const Session& session) ABSL_LOCKS_EXCLUDED(mutex_);

  enum class Found { kNothing, kWaiting, kBeingSaved, kWithdrawn };
  /// Has a session not saved after all; one that is being saved is undone. Returns where it was: kWithdrawn where it is being
  /// undone already.
  Found withdraw(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether a session is being saved that has been withdrawn.
  bool is_withdrawn(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Waits until it is not, and undone.
  void wait_until_undone(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  /// The session has left the memory: it is tried once, where it has not been, and then given up.
  void let_go(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether a session waits or is being saved.
  bool has(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Which do.
  std::vector<std::string> ids() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// How many do.
  std::size_t size() const ABSL_LOCKS_EXCLUDED(mutex_);

  /// Tries each that waits once more, and ends the thread.
  void stop() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Entry {
    std::shared_ptr<const Session> session;
    Clock::time_point due = {};
    Clock::duration wait = {};  // until then, the last time; 0: it has not been tried
    bool is_let_go = false;     // no further try
  };

  void run() ABSL_LOCKS_EXCLUDED(mutex_);
  void try_next(const std::string& id) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// The one that is due first; end() where none waits.
  std::map<std::string, Entry>::iterator first_due() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Hooks hooks_;
  const Clock::duration first_wait_, longest_wait_;
  mutable Mutex mutex_;
  CondVar changed_;
  std::map<std::string, Entry> entries_ ABSL_GUARDED_BY(mutex_);  // that wait
  std::string saving_ ABSL_GUARDED_BY(mutex_);                    // the session that is being saved; empty: none
  bool is_withdrawn_ ABSL_GUARDED_BY(mutex_) = false;             // that one
  bool is_let_go_ ABSL_GUARDED_BY(mutex_) = false;                // as well
  bool is_stopping_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::thread thread_ ABSL_GUARDED_BY(join_mutex_);  // last
};

}  // namespace curvecast::server
