// A small pool of workers with a bounded queue that is fair to those for whom it works.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Every accepted job runs exactly once unless it is withdrawn, so that a job may own what it has to finish.
/// Jobs must not throw.
///
/// Each job belongs to a client. The next job is one of the client that has the fewest running, then of the one that has had the
/// least of the workers' time; jobs of one client keep their order. A client does not save up time that it left to others
/// (start-time fair queueing: Goyal, Vin and Cheng, IEEE/ACM Transactions on Networking 5, 1997). So a client that wants
/// everything slows those that want little down by no more than the job that happens to be running.
class JobQueue {
 public:
  using Nanoseconds = std::chrono::nanoseconds;

  struct Options {
    int workers = 1;                                                           // >= 1
    std::size_t max_waiting = 0;                                               // jobs
    std::size_t max_waiting_of_one = std::numeric_limits<std::size_t>::max();  // jobs of one client
    int max_running_of_one = std::numeric_limits<int>::max();                  // jobs of one client
    bool low_priority = false;                                                 // workers call lower_priority()
    /// Time since any moment, never less than before. Called by all workers.
    std::function<Nanoseconds()> clock = [] { return Nanoseconds(std::chrono::steady_clock::now().time_since_epoch()); };
  };

  explicit JobQueue(Options options);
  ~JobQueue();  // stop()
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Accepts a job of the client `whose`, and returns a ticket for withdraw(). ResourceExhausted when too many wait, Unavailable
  /// after stop().
  absl::StatusOr<std::uint64_t> submit(std::function<void()> job, std::string_view whose = "");
  /// Takes back a job that has not started; false when it has.
  bool withdraw(std::uint64_t ticket);
  /// How many jobs wait for a worker.
  std::size_t waiting() const;
  /// Accepts no more, runs what was accepted to its end (cancel it before), joins the workers. Not from a job.
  void stop();

 private:
  /// The jobs of one client.
  struct Lane {
    std::map<std::uint64_t, std::function<void()>> waiting;  // by ticket
    int running = 0;
    Nanoseconds used{};  // of the workers' time, on the clock of `turn_`
  };
  using Lanes = std::map<std::string, Lane, std::less<>>;

  void work() ABSL_LOCKS_EXCLUDED(mutex_);
  /// The lane whose turn it is; end() where none has a job that may run.
  Lanes::iterator next_lane() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Drops lanes without jobs that have had no more than their share, once there are many lanes.
  void forget_idle() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Options options_;
  mutable Mutex mutex_;
  CondVar wake_;
  Lanes lanes_ ABSL_GUARDED_BY(mutex_);              // with jobs, or that have had more than their share
  std::size_t waiting_ ABSL_GUARDED_BY(mutex_) = 0;  // jobs, in all lanes
  int running_ ABSL_GUARDED_BY(mutex_) = 0;
  // The most that a lane had used when its turn came: where those that join begin.
  Nanoseconds turn_ ABSL_GUARDED_BY(mutex_){};
  std::size_t forget_at_ ABSL_GUARDED_BY(mutex_) = 64;  // number of lanes
  std::uint64_t next_ticket_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::vector<std::thread> workers_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace curvecast::server
