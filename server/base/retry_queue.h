// Has things done in the background, one after the other, each again and again until that succeeds.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Things are known by an id, such as that of a session which is to be saved.
class RetryQueue {
 public:
  using Clock = std::chrono::steady_clock;
  /// Tries it. An error that passes by itself, such as a full disk, has it tried again; Cancelled, DataLoss and InvalidArgument
  /// do not. `cancel` is set when it is withdrawn. Called without locks, by the queue's thread.
  using Attempt = std::function<absl::Status(const std::atomic<bool>& cancel)>;

  /// Called by the queue's thread with the lock held.
  struct Hooks {
    /// Removes what was done by an attempt that was withdrawn meanwhile. May be empty.
    std::function<void(const std::string& id)> undo;
    /// Tells how an attempt went that nobody has withdrawn. `is_lost`: there will be no other. May be empty.
    std::function<void(const std::string& id, const absl::Status& status, bool is_lost)> on_tried;
  };

  /// After a failure the next try is after `first_wait`, then after twice as long each time, but never more than `longest_wait`.
  explicit RetryQueue(Hooks hooks, Clock::duration first_wait = std::chrono::seconds(1),
                      Clock::duration longest_wait = std::chrono::seconds(10));
  ~RetryQueue();  // stop()
  RetryQueue(const RetryQueue&) = delete;
  RetryQueue& operator=(const RetryQueue&) = delete;

  /// Has it tried, now or after those that wait, instead of the attempt that waits for this id. Does nothing after stop().
  void put(const std::string& id, Attempt attempt) ABSL_LOCKS_EXCLUDED(mutex_);

  enum class Found { kNothing, kWaiting, kBeingTried, kWithdrawn };
  /// Has it not done after all; what is being tried is undone. Returns where it was: kWithdrawn where it is being undone already.
  Found withdraw(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether it is being tried, and has been withdrawn.
  bool is_withdrawn(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Waits until it is not, and undone.
  void wait_until_undone(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  /// It is tried once, where it has not been, and then given up.
  void let_go(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether it waits or is being tried.
  bool has(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Which do.
  std::vector<std::string> ids() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// How many do.
  std::size_t size() const ABSL_LOCKS_EXCLUDED(mutex_);

  /// Tries each that waits once more, and ends the thread.
  void stop() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Entry {
    Attempt attempt;
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
  std::string trying_ ABSL_GUARDED_BY(mutex_);                    // what is being tried; empty: nothing
  std::atomic<bool> is_withdrawn_ = false;                        // that; written with the lock held
  bool is_let_go_ ABSL_GUARDED_BY(mutex_) = false;                // as well
  bool is_stopping_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::thread thread_ ABSL_GUARDED_BY(join_mutex_);  // last
};

}  // namespace curvecast::server
