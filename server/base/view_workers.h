// Workers for views: a client that asks for little gets it at once, whatever others ask for.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"

namespace curvecast::server {

/// Thread-safe. Has two fair queues with as many workers each. Jobs of a connection that takes no more than kShare of one
/// worker's time go to the first queue; jobs of one that takes more go to the second, whose workers are of low priority: they run
/// at full speed on an idle machine and yield under load. In both the callers share the workers, and their connections what their
/// caller has; and there is one worker more than a caller gets at once, so that nobody waits for the end of another's long jobs.
class ViewWorkers {
 public:
  using Nanoseconds = JobQueue::Nanoseconds;

  static constexpr double kShare = 0.25;
  static constexpr Nanoseconds kBurst = std::chrono::milliseconds(250);  // of work that a connection may have saved up

  struct Options {
    int workers = 1;                     // of each queue, for one caller; >= 1
    std::size_t max_waiting = 0;         // in each queue
    std::size_t max_waiting_of_one = 0;  // ... of one caller
    std::function<Nanoseconds()> clock = JobQueue::Options().clock;
    /// Called by the worker after each job: how long it waited for the worker, and took of it. May be empty.
    std::function<void(Nanoseconds waited, Nanoseconds took)> on_done = {};
  };

  explicit ViewWorkers(const Options& options);

  /// Accepts a job of a caller's connection. Errors as of JobQueue::submit().
  absl::Status submit(std::function<void()> job, const std::string& caller, const std::string& connection);
  /// How many jobs wait for a worker.
  std::size_t waiting() const { return quick_.waiting() + patient_.waiting(); }
  /// As JobQueue::refused(), of both queues.
  std::uint64_t refused() const { return quick_.refused() + patient_.refused(); }
  /// As JobQueue::overdue() and tell_overdue(), of both queues.
  std::size_t overdue() const { return quick_.overdue() + patient_.overdue(); }
  void tell_overdue(const std::function<void(const std::string& caller, Nanoseconds time)>& tell);
  /// As JobQueue::stop(), for both queues.
  void stop();

 private:
  struct Account {
    Nanoseconds left = kBurst;  // of work, at `at`
    Nanoseconds at{};
  };

  /// The work that a connection may have done at once; below zero: it has had more than its share. Forgets connections that may
  /// have as much as a new one.
  Nanoseconds& left(const std::string& connection) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void run(const std::function<void()>& job, const std::string& connection, Nanoseconds submitted) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::function<Nanoseconds()> clock_;
  const std::function<void(Nanoseconds, Nanoseconds)> on_done_;
  Mutex mutex_;
  std::map<std::string, Account> accounts_ ABSL_GUARDED_BY(mutex_);
  std::size_t forget_at_ ABSL_GUARDED_BY(mutex_) = 64;  // number of accounts
  JobQueue quick_, patient_;                            // last: their jobs use the others
};

}  // namespace curvecast::server
