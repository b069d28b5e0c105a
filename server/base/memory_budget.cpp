#include "server/base/memory_budget.h"

#include <absl/strings/str_cat.h>

#include <algorithm>

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

// So often a job that waits looks whether its client has gone, and what is held by now.
constexpr std::chrono::milliseconds kLook{50};
// So often where no other job will give anything back: who has just been answered may still hold what is idle a moment later.
constexpr int kLooksAlone = 5;

}  // namespace

MemoryBudget::Job::~Job() {
  const MutexLock lock(budget_.mutex_);
  budget_.release(*this, taken_);
}

void MemoryBudget::Job::give_back(std::uint64_t bytes) {
  const MutexLock lock(budget_.mutex_);
  if (terms_.keeps) {
    spare_ += bytes;
  } else {
    budget_.release(*this, bytes);
  }
}

absl::Status MemoryBudget::Job::take(std::uint64_t bytes, const std::string& what) {
  const Clock::time_point end = Clock::now() + (terms_.waits ? budget_.options_.patience : Clock::duration::zero());
  int looks_alone = 0;
  for (;;) {
    const std::uint64_t most = budget_.most(terms_);
    std::uint64_t held = budget_.options_.held();
    if (budget_.try_take(*this, bytes, most, held)) return absl::OkStatus();
    if (budget_.exceeds(*this, bytes, most)) return budget_.refuse(what, most);
    budget_.options_.make_room(bytes);
    held = budget_.options_.held();
    if (budget_.try_take(*this, bytes, most, held)) return absl::OkStatus();
    if (cancel_ != nullptr && *cancel_) return absl::CancelledError("cancelled");
    if (!budget_.wait_for_others(*this, end, looks_alone)) {
      ++budget_.refused_;
      return absl::ResourceExhaustedError(absl::StrCat(what, "; of the ", describe_bytes(static_cast<double>(most)),
                                                       " that this server has, too many are in use; try again later"));
    }
  }
}

absl::Status MemoryBudget::Outlook::take(std::uint64_t bytes, const std::string& what) {
  const std::uint64_t most = budget_.most({});
  return bytes > most ? budget_.refuse(what, most) : absl::OkStatus();
}

std::uint64_t MemoryBudget::most(const MemoryTerms& terms) const {
  const std::uint64_t all = options_.most();
  return terms.waits ? all - static_cast<std::uint64_t>(options_.left_by_waiting * static_cast<double>(all)) : all;
}

absl::Status MemoryBudget::refuse(const std::string& what, std::uint64_t most) {
  ++refused_;
  return absl::ResourceExhaustedError(
      absl::StrCat(what, "; this server has ", describe_bytes(static_cast<double>(most)), " for all of its work"));
}

std::uint64_t MemoryBudget::reserved() const {
  const MutexLock lock(mutex_);
  return reserved_;
}

void MemoryBudget::release(Job& job, std::uint64_t bytes) {
  job.budget_.mutex_.assert_held();
  if (bytes == 0) return;
  job.taken_ -= bytes;
  reserved_ -= bytes;
  if (job.taken_ == 0) --active_;
  given_back_.notify_all();
}

bool MemoryBudget::exceeds(const Job& job, std::uint64_t bytes, std::uint64_t most) const {
  const MutexLock lock(mutex_);
  job.budget_.mutex_.assert_held();
  return bytes > most || job.taken_ - job.spare_ > most - bytes;
}

bool MemoryBudget::try_take(Job& job, std::uint64_t bytes, std::uint64_t most, std::uint64_t held) {
  const MutexLock lock(mutex_);
  job.budget_.mutex_.assert_held();
  const std::uint64_t again = std::min(bytes, job.spare_), more = bytes - again, in_use = held + reserved_;
  if (more > 0 && (in_use > most || more > most - in_use)) return false;
  if (job.taken_ == 0 && more > 0) ++active_;
  job.spare_ -= again;
  job.taken_ += more;
  reserved_ += more;
  return true;
}

bool MemoryBudget::wait_for_others(const Job& job, Clock::time_point end, int& looks_alone) {
  const MutexLock lock(mutex_);
  job.budget_.mutex_.assert_held();
  // Of jobs that all wait for each other one has to give up.
  const int here = job.taken_ > 0 ? 1 : 0;
  const bool is_alone = active_ - blocked_ - here <= 0;
  if ((is_alone && ++looks_alone > kLooksAlone) || Clock::now() >= end) return false;
  blocked_ += here;
  given_back_.wait_until(mutex_, std::min(end, Clock::now() + kLook));
  blocked_ -= here;
  return true;
}

}  // namespace curvecast::server
