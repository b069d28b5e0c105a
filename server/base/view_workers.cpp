#include "server/base/view_workers.h"

#include <algorithm>
#include <utility>

namespace curvecast::server {

ViewWorkers::ViewWorkers(const Options& options)
    : clock_(options.clock),
      on_done_(options.on_done),
      callers_(options.workers / 2., kCallerBurst),
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

absl::Status ViewWorkers::submit(std::function<void()> job, const JobQueue::Claim& claim) {
  const Nanoseconds now = clock_();
  Payer payer{.caller = std::string(claim.caller), .connection = std::string(claim.connection), .paid = claim.expected};
  bool is_quick;
  {
    const MutexLock lock(mutex_);
    const Nanoseconds longest = callers_.left(claim.caller, now) >= Nanoseconds::zero() ? kLong : kShort;
    is_quick = connections_.left(claim.connection, now) >= Nanoseconds::zero() && claim.expected < longest;
    pay(payer, payer.paid, now);
  }
  const absl::Status accepted =
      (is_quick ? quick_ : patient_).submit([this, job = std::move(job), payer, now] { run(job, payer, now); }, claim).status();
  if (!accepted.ok()) {
    const MutexLock lock(mutex_);
    pay(payer, -payer.paid, clock_());
  }
  return accepted;
}

void ViewWorkers::tell_overdue(const std::function<void(const std::string&, Nanoseconds)>& tell) {
  quick_.tell_overdue(tell);
  patient_.tell_overdue(tell);
}

void ViewWorkers::stop() {
  quick_.stop();
  patient_.stop();
}

ViewWorkers::Nanoseconds ViewWorkers::Accounts::saved_up(const Account& account, Nanoseconds now) const {
  const auto more = std::chrono::duration_cast<Nanoseconds>(share_ * (now - account.at));
  return std::min(burst_, account.left + more);
}

ViewWorkers::Nanoseconds& ViewWorkers::Accounts::left(std::string_view name, Nanoseconds now) {
  const auto found = accounts_.find(name);
  if (found == accounts_.end() && accounts_.size() >= forget_at_) {
    std::erase_if(accounts_, [&](const auto& entry) { return saved_up(entry.second, now) == burst_; });
    forget_at_ = std::max<std::size_t>(64, 2 * accounts_.size());
  }
  Account& account = found != accounts_.end() ? found->second : accounts_.emplace(name, Account{burst_, now}).first->second;
  account = {saved_up(account, now), now};
  return account.left;
}

void ViewWorkers::pay(const Payer& payer, Nanoseconds time, Nanoseconds now) {
  connections_.left(payer.connection, now) -= time;
  callers_.left(payer.caller, now) -= time;
}

void ViewWorkers::run(const std::function<void()>& job, const Payer& payer, Nanoseconds submitted) {
  const Nanoseconds start = clock_();
  job();
  const Nanoseconds end = clock_(), spent = end - start;
  if (on_done_) on_done_(start - submitted, spent);
  const MutexLock lock(mutex_);
  pay(payer, spent - payer.paid, end);
}

}  // namespace curvecast::server
