// Workers for views: a client that asks for little gets it at once, whatever others ask for.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"

namespace curvecast::server {

/// Thread-safe. Has two fair queues with as many workers each. Jobs of a connection that takes no more than kShare of one
/// worker's time go to the first queue; jobs of one that takes more go to the second, whose workers are of low priority: they run
/// at full speed on an idle machine and yield under load. So do jobs of kShort and more of a caller whose connections take more
/// than half of all workers' time together: from however many connections, he has the first queue for kCallerBurst and no longer.
/// So does each job of kLong and more, whoever asks: it is hardly later for yielding to short ones, and they are much later for
/// waiting.
/// In both the callers share the workers, and their connections what their caller has; and there is one worker more than a caller
/// gets at once, so that nobody waits for the end of another's long jobs.
class ViewWorkers {
 public:
  using Nanoseconds = JobQueue::Nanoseconds;

  static constexpr double kShare = 0.25;
  static constexpr Nanoseconds kBurst = std::chrono::milliseconds(250);        // of work that a connection may have saved up
  static constexpr Nanoseconds kCallerBurst = std::chrono::milliseconds(500);  // ... a caller
  static constexpr Nanoseconds kShort = std::chrono::milliseconds(5);
  static constexpr Nanoseconds kLong = std::chrono::milliseconds(25);

  struct Options {
    int workers = 1;                     // of each queue, for one caller; >= 1
    std::size_t max_waiting = 0;         // in each queue
    std::size_t max_waiting_of_one = 0;  // ... of one caller
    std::function<Nanoseconds()> clock = JobQueue::Options().clock;
    /// Called by the worker after each job: how long it waited for the worker, and took of it. May be empty.
    std::function<void(Nanoseconds waited, Nanoseconds took)> on_done = {};
  };

  explicit ViewWorkers(const Options& options);

  /// Accepts a job. Errors as of JobQueue::submit(). What it is expected to take is paid at once, and settled at its end.
  absl::Status submit(std::function<void()> job, const JobQueue::Claim& claim);
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
  /// What each of many may have done at once, in time of workers; below zero: it has had more than its share.
  class Accounts {
   public:
    Accounts(double share, Nanoseconds burst) : share_(share), burst_(burst) {}
    /// May forget who has as much as a new one, so that a reference is valid until the next call.
    Nanoseconds& left(std::string_view name, Nanoseconds now);

   private:
    struct Account {
      Nanoseconds left{};  // at `at`
      Nanoseconds at{};
    };
    Nanoseconds saved_up(const Account& account, Nanoseconds now) const;

    double share_;
    Nanoseconds burst_;
    std::map<std::string, Account, std::less<>> accounts_;
    std::size_t forget_at_ = 64;  // number of accounts
  };
  /// Who pays for a job, and what was paid for it.
  struct Payer {
    std::string caller, connection;
    Nanoseconds paid{};
  };

  void pay(const Payer& payer, Nanoseconds time, Nanoseconds now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void run(const std::function<void()>& job, const Payer& payer, Nanoseconds submitted) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::function<Nanoseconds()> clock_;
  const std::function<void(Nanoseconds, Nanoseconds)> on_done_;
  Mutex mutex_;
  Accounts connections_ ABSL_GUARDED_BY(mutex_){kShare, kBurst};
  Accounts callers_ ABSL_GUARDED_BY(mutex_);
  JobQueue quick_, patient_;  // last: their jobs use the others
};

}  // namespace curvecast::server
