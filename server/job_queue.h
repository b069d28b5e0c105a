// A small pool of workers with a bounded queue.
#pragma once

#include <absl/status/statusor.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace curvecast::server {

/// Thread-safe. Every accepted job runs exactly once unless it is withdrawn, so that a job may own what it has to finish.
/// Jobs must not throw.
class JobQueue {
 public:
  /// `workers` >= 1; at most `max_pending` jobs wait.
  JobQueue(int workers, std::size_t max_pending);
  ~JobQueue();  // stop()
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// A ticket for withdraw(). ResourceExhausted when too many wait, Unavailable after stop().
  absl::StatusOr<std::uint64_t> submit(std::function<void()> job);
  /// Takes back a job that has not started; false when it has.
  bool withdraw(std::uint64_t ticket);
  /// How many jobs wait for a worker.
  std::size_t waiting() const;
  /// Accepts no more, runs what was accepted to its end (cancel it before), joins the workers. Not from a job.
  void stop();

 private:
  void work();

  const std::size_t max_pending_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::uint64_t, std::function<void()>> pending_;  // by ticket: first come, first served
  std::uint64_t next_ticket_ = 0;
  bool stopped_ = false;
  std::mutex join_mutex_;
  std::vector<std::thread> workers_;
};

}  // namespace curvecast::server
