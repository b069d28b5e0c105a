// Workers for views: who asks for little gets it at once, whatever others ask for.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "server/base/job_queue.h"

namespace curvecast::server {

/// Thread-safe. Jobs are of connections, and go to one of two fair queues with as many workers each. Those of a connection whose
/// jobs take no more than kShare of one worker's time go to the first; what takes more goes to the second, whose workers are of
/// low priority: beside nobody they are as fast, and beside others they wait.
class ViewWorkers {
 public:
  using Nanoseconds = JobQueue::Nanoseconds;

  static constexpr double kShare = 0.25;
  static constexpr Nanoseconds kBurst = std::chrono::milliseconds(250);  // of work that a connection may have saved up

  struct Options {
    int workers = 1;              // of each queue, >= 1
    std::size_t max_waiting = 0;  // in each queue
    std::size_t max_waiting_of_one = 0;
    std::function<Nanoseconds()> clock = JobQueue::Options().clock;
  };

  explicit ViewWorkers(const Options& options);

  /// Errors as of JobQueue.
  absl::Status submit(std::function<void()> job, const std::string& connection);
  std::size_t waiting() const { return quick_.waiting() + patient_.waiting(); }
  /// JobQueue::stop().
  void stop();

 private:
  struct Account {
    Nanoseconds left = kBurst;  // of work, at `at`
    Nanoseconds at{};
  };

  /// What a connection may do at once; forgets those that may do what a new one may.
  Nanoseconds& left(const std::string& connection);
  void run(const std::function<void()>& job, const std::string& connection);

  const std::function<Nanoseconds()> clock_;
  std::mutex mutex_;
  std::map<std::string, Account> accounts_;
  std::size_t forget_at_ = 64;  // number of accounts
  JobQueue quick_, patient_;    // last: their jobs use the others
};

}  // namespace curvecast::server
