// A small pool of workers with a bounded queue that is fair to those for whom it works.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Every accepted job runs exactly once unless it is withdrawn, so that a job may own what it has to finish.
/// Jobs must not throw.
///
/// Each job belongs to a connection of a caller. The next job is one of the caller that has the fewest running, then of the one
/// that will have had the least of the workers' time when the job is done as expected; of that caller it is one of the connection
/// of which the same can be said. So jobs of one connection keep their order, but that short ones go before long ones, which
/// wait until their caller has had as much time as they take. Nobody saves up time that he left to others (start-time fair
/// queueing: Goyal, Vin and Cheng, IEEE/ACM Transactions on Networking 5, 1997). So a caller that wants everything, from however
/// many connections, slows those that want little down by no more than the job that happens to be running; and where that one is
/// expected to take as long as `Options::long_job` not even by that, for of several workers one takes no such jobs.
class JobQueue {
 public:
  using Nanoseconds = std::chrono::nanoseconds;

  struct Options {
    int workers = 1;                                                           // >= 1
    std::size_t max_waiting = 0;                                               // jobs
    std::size_t max_waiting_of_one = std::numeric_limits<std::size_t>::max();  // jobs of one caller
    int max_running_of_one = std::numeric_limits<int>::max();                  // jobs of one caller
    bool low_priority = false;                                                 // workers call lower_priority()
    Nanoseconds long_job = Nanoseconds::max();                                 // see below
    Nanoseconds patience = std::chrono::minutes(1);                            // see overdue()
    /// Time since any moment, never less than before. Called by all workers.
    std::function<Nanoseconds()> clock = [] { return Nanoseconds(std::chrono::steady_clock::now().time_since_epoch()); };
  };

  explicit JobQueue(Options options);
  ~JobQueue();  // stop()
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Whose a job is, and how long it will take, if that is known.
  struct Claim {
    std::string_view caller = {};
    std::string_view connection = {};
    Nanoseconds expected{};
  };

  /// Accepts a job, and returns a ticket for withdraw(). ResourceExhausted when too many wait, Unavailable after stop().
  absl::StatusOr<std::uint64_t> submit(std::function<void()> job, const Claim& claim);
  absl::StatusOr<std::uint64_t> submit(std::function<void()> job, std::string_view caller = "") {
    return submit(std::move(job), Claim{.caller = caller});
  }
  /// Takes back a job that has not started; false when it has.
  bool withdraw(std::uint64_t ticket);
  /// How many jobs wait for a worker.
  std::size_t waiting() const;
  /// How often submit() has refused a job because too many waited.
  std::uint64_t refused() const { return refused_; }
  /// How many running jobs have taken ten times as long as was expected of them, and `patience` more: they may be stuck.
  std::size_t overdue() const;
  /// Calls tell(caller, time) for each of them, once. `tell` must not call the queue.
  void tell_overdue(const std::function<void(const std::string& caller, Nanoseconds time)>& tell);
  /// Accepts no more, runs what was accepted to its end (cancel it before), joins the workers. Not from a job.
  void stop();

 private:
  struct Job {
    std::function<void()> run;
    Nanoseconds expected;
  };
  struct Running {
    std::string caller;
    Nanoseconds start, expected;
    bool was_told = false;  // that it is overdue
  };
  /// Jobs that wait, by the time that their connection will have used after each, then by ticket.
  using Jobs = std::map<std::pair<Nanoseconds, std::uint64_t>, Job>;
  /// What somebody has of the workers.
  struct Share {
    int running = 0;
    Nanoseconds used{};  // of their time, on the clock of the `turn` that all who share with him have in common
  };
  /// A connection.
  struct Lane : Share {
    Jobs waiting;
  };
  using Lanes = std::map<std::string, Lane, std::less<>>;
  struct Caller : Share {
    Lanes lanes;  // with jobs, or that have had more than their share
    std::size_t waiting = 0;
    Nanoseconds turn{};
  };
  using Callers = std::map<std::string, Caller, std::less<>>;
  /// Where a job waits.
  struct Place {
    Caller* caller;
    Lane* lane;
    Nanoseconds at;
  };
  /// Compared first to last: who has the smaller one is next.
  using Order = std::tuple<int, Nanoseconds, std::uint64_t>;

  /// The job whose turn it is, with its lane and caller; null where none may run.
  struct Turn {
    std::string name;  // the caller's
    Caller* caller = nullptr;
    Lane* lane = nullptr;
    Jobs::iterator job;
  };

  void work() ABSL_LOCKS_EXCLUDED(mutex_);
  bool is_overdue(const Running& job, Nanoseconds now) const { return now - job.start > 10 * job.expected + options_.patience; }
  bool is_long(Nanoseconds expected) const { return expected >= options_.long_job; }
  static Order order_of(const Share& share, Jobs::iterator job);
  /// The caller's next job, or the next of those that are not long.
  Turn next_of(const std::string& name, Caller& caller, bool may_be_long);
  Turn next_turn() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Lane& lane_of(const Claim& claim, Caller& caller) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Drops callers and lanes without jobs that have had no more than their share, once there are many.
  void forget_idle() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Options options_;
  std::atomic<std::uint64_t> refused_ = 0;
  mutable Mutex mutex_;
  CondVar wake_;
  Callers callers_ ABSL_GUARDED_BY(mutex_);                           // with jobs, or that have had more than their share
  std::map<std::uint64_t, Place> places_ ABSL_GUARDED_BY(mutex_);     // of those that wait, by ticket
  std::map<std::uint64_t, Running> running_ ABSL_GUARDED_BY(mutex_);  // by ticket
  // The most that a caller had used when its turn came: where those that join begin. A caller has the same for its lanes.
  Nanoseconds turn_ ABSL_GUARDED_BY(mutex_){};
  std::size_t lanes_ ABSL_GUARDED_BY(mutex_) = 0;       // of all callers
  std::size_t forget_at_ ABSL_GUARDED_BY(mutex_) = 64;  // of them
  std::uint64_t next_ticket_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  Mutex join_mutex_;
  std::vector<std::thread> workers_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace curvecast::server
