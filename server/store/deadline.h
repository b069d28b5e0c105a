// How long one call may take, whatever it waits for.
#pragma once

#include <absl/status/status.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

namespace curvecast::server {

class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  /// Over after `time`, and once `cancel` is set, which may be null.
  Deadline(Clock::duration time, const std::atomic<bool>* cancel) : begin_(Clock::now()), end_(begin_ + time), cancel_(cancel) {}

  /// Gives a call time to carry so many bytes besides, if it goes on at `rate` (bytes a second), but at most twelve hours.
  void allow(std::uint64_t bytes, std::uint64_t rate) {
    const std::chrono::seconds more(std::min<std::uint64_t>(bytes / rate, 12 * 60 * 60));
    end_ += std::max<Clock::duration>(more - allowed_, {});
    allowed_ = std::max(allowed_, more);
  }

  /// Cancelled, or Unavailable where time is up.
  absl::Status check() const {
    if (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) return absl::CancelledError("cancelled");
    if (Clock::now() < end_) return absl::OkStatus();
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(end_ - begin_).count();
    return absl::UnavailableError("it took longer than " + std::to_string(seconds) + " s");
  }

  /// Waits, and returns what check() says then, as soon as it says anything.
  absl::Status sleep(Clock::duration time) const {
    constexpr Clock::duration kSlice = std::chrono::milliseconds(20);
    const Clock::time_point until = Clock::now() + time;
    while (check().ok() && Clock::now() < until) std::this_thread::sleep_for(std::min(kSlice, until - Clock::now()));
    return check();
  }

 private:
  const Clock::time_point begin_;
  Clock::time_point end_;
  std::chrono::seconds allowed_{0};
  const std::atomic<bool>* const cancel_;
};

}  // namespace curvecast::server
