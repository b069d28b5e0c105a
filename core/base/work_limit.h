// How much of the processors' time a computation may take.
#pragma once

#include <time.h>

#include <atomic>
#include <chrono>

namespace curvecast {

/// Counts the time that the threads of one computation spend on it. Thread-safe.
class WorkLimit {
 public:
  using Nanoseconds = std::chrono::nanoseconds;

  /// `most`: of all threads together.
  explicit WorkLimit(Nanoseconds most) : left_(most.count()) {}

  /// Takes away from what is left.
  void spend(Nanoseconds time) { left_ -= time.count(); }
  /// Whether no time is left.
  bool is_spent() const { return left_ <= 0; }

  /// Spends what the calling thread takes of a processor, from its construction on or from the last settle().
  class Meter {
   public:
    /// `limit` may be null.
    explicit Meter(WorkLimit* limit) : limit_(limit), start_(thread_time()) {}
    void settle() {
      if (limit_ == nullptr) return;
      const Nanoseconds now = thread_time();
      limit_->spend(now - start_);
      start_ = now;
    }

   private:
    /// Of a processor, not of the clock: a busy machine is not the computation's fault.
    static Nanoseconds thread_time() {
      timespec time{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
      return std::chrono::seconds(time.tv_sec) + Nanoseconds(time.tv_nsec);
    }

    WorkLimit* const limit_;
    Nanoseconds start_;
  };

 private:
  std::atomic<Nanoseconds::rep> left_;
};

}  // namespace curvecast
