// How often something may happen.
#pragma once

#include <algorithm>
#include <chrono>

namespace curvecast::server {

/// Lets something happen so many times a second in the long run, and a second's worth of times at once. Whoever wants more waits
/// rarely and long rather than each time: to wait and to be woken costs more than what it is for. Not thread-safe.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr double kPause = 0.02;  // seconds, at least

  explicit RateLimit(double per_second) : per_second_(per_second), left_(per_second) {}

  /// Counts that it happens once, and returns how long to wait before the next time.
  Clock::duration take(Clock::time_point now) {
    left_ = std::min(per_second_, left_ + per_second_ * std::chrono::duration<double>(now - last_).count()) - 1;
    last_ = now;
    if (left_ >= 0) return Clock::duration::zero();
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(-left_ / per_second_ + kPause));
  }

 private:
  double per_second_, left_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace curvecast::server
