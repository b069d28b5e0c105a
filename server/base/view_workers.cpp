#include "server/base/view_workers.h"

#include <algorithm>
#include <utility>

namespace curvecast::server {
namespace {

using Nanoseconds = ViewWorkers::Nanoseconds;

Nanoseconds saved_up(Nanoseconds left, Nanoseconds passed) {
  const auto more = std::chrono::duration_cast<Nanoseconds>(ViewWorkers::kShare * passed);
  return std::min(ViewWorkers::kBurst, left + more);
}

}  // namespace

ViewWorkers::ViewWorkers(const Options& options)
    : clock_(options.clock),
      on_done_(options.on_done),
      quick_({.workers = options.workers + 1,
              .max_waiting = options.max_waiting,
              .max_waiting_of_one = options.max_waiting_of_one,
              .max_running_of_one = options.workers,
              .clock = options.clock}),
      patient_({.workers = options.workers + 1,
                .max_waiting = options.max_waiting,
                .max_waiting_of_one = options.max_waiting_of_one,
                .max_running_of_one = options.workers,
                .low_priority = true,
                .clock = options.clock}) {}

absl::Status ViewWorkers::submit(std::function<void()> job, const std::string& caller, const std::string& connection) {
  bool is_quick;
  {
    const MutexLock lock(mutex_);
    is_quick = left(connection) >= Nanoseconds::zero();
  }
  return (is_quick ? quick_ : patient_)
      .submit([this, job = std::move(job), connection, submitted = clock_()] { run(job, connection, submitted); },
              {.caller = caller, .connection = connection})
      .status();
}

void ViewWorkers::tell_overdue(const std::function<void(const std::string&, Nanoseconds)>& tell) {
  quick_.tell_overdue(tell);
  patient_.tell_overdue(tell);
}

void ViewWorkers::stop() {
  quick_.stop();
  patient_.stop();
}

Nanoseconds& ViewWorkers::left(const std::string& connection) {
  const Nanoseconds now = clock_();
  const auto found = accounts_.find(connection);
  if (found == accounts_.end() && accounts_.size() >= forget_at_) {
    std::erase_if(accounts_, [now](const auto& entry) { return saved_up(entry.second.left, now - entry.second.at) == kBurst; });
    forget_at_ = std::max<std::size_t>(64, 2 * accounts_.size());
  }
  Account& account = found != accounts_.end() ? found->second : accounts_.emplace(connection, Account{.at = now}).first->second;
  account.left = saved_up(account.left, now - account.at);
  account.at = now;
  return account.left;
}

void ViewWorkers::run(const std::function<void()>& job, const std::string& connection, Nanoseconds submitted) {
  const Nanoseconds start = clock_();
  job();
  const Nanoseconds spent = clock_() - start;
  if (on_done_) on_done_(start - submitted, spent);
  const MutexLock lock(mutex_);
  left(connection) -= spent;
}

}  // namespace curvecast::server
