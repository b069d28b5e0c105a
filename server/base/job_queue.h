// A small pool of workers with a bounded queue that is fair to those for whom it works.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace curvecast::server {

/// Thread-safe. Every accepted job runs exactly once unless it is withdrawn, so that a job may own what it has to finish.
/// Jobs must not throw.
///
/// Each job is somebody's. Next is one of whoever has the fewest running, then of whoever has had the least of the workers' time;
/// one's own come in their order. Time that somebody did not use while others did is not saved up (start-time fair queueing:
/// Goyal, Vin and Cheng, IEEE/ACM Transactions on Networking 5, 1997). So one who wants everything slows those who want little
/// down by no more than the job that happens to be running.
class JobQueue {
 public:
  using Nanoseconds = std::chrono::nanoseconds;

  struct Options {
    int workers = 1;              // >= 1
    std::size_t max_waiting = 0;  // jobs
    std::size_t max_waiting_of_one = std::numeric_limits<std::size_t>::max();
    int max_running_of_one = std::numeric_limits<int>::max();
    bool low_priority = false;  // lower_priority()
    /// Time since any moment, never less than before. Called by all workers.
    std::function<Nanoseconds()> clock = [] { return Nanoseconds(std::chrono::steady_clock::now().time_since_epoch()); };
  };

  explicit JobQueue(Options options);
  ~JobQueue();  // stop()
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// A ticket for withdraw(). ResourceExhausted when too many wait, Unavailable after stop().
  absl::StatusOr<std::uint64_t> submit(std::function<void()> job, std::string_view whose = "");
  /// Takes back a job that has not started; false when it has.
  bool withdraw(std::uint64_t ticket);
  /// How many jobs wait for a worker.
  std::size_t waiting() const;
  /// Accepts no more, runs what was accepted to its end (cancel it before), joins the workers. Not from a job.
  void stop();

 private:
  struct Lane {
    std::map<std::uint64_t, std::function<void()>> waiting;  // by ticket
    int running = 0;
    Nanoseconds used{};  // of the workers' time, on the clock of `turn_`
  };
  using Lanes = std::map<std::string, Lane, std::less<>>;

  void work();
  /// The lane whose turn it is; end() where none has a job that may run.
  Lanes::iterator next_lane();
  void forget_idle();

  const Options options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Lanes lanes_;              // with jobs, or that have had more than their share
  std::size_t waiting_ = 0;  // jobs, in all lanes
  int running_ = 0;
  Nanoseconds turn_{};          // the most that a lane had used when its turn came: where those that join begin
  std::size_t forget_at_ = 64;  // number of lanes
  std::uint64_t next_ticket_ = 0;
  bool stopped_ = false;
  std::mutex join_mutex_;
  std::vector<std::thread> workers_;
};

}  // namespace curvecast::server
