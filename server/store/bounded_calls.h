// Work that may hang in the system, as on a folder of another machine that does not answer.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace curvecast::server {

/// How far a call is, and whether anybody still waits for it. Thread-safe.
class CallProgress {
 public:
  /// The call gets on.
  void step() { steps_.fetch_add(1, std::memory_order_relaxed); }
  /// Whether nobody waits any more: the call had better end, and leave nothing behind.
  bool is_given_up() const { return is_given_up_; }

 private:
  friend class BoundedCalls;
  std::atomic<std::uint64_t> steps_ = 0;
  std::atomic<bool> is_given_up_ = false;
};

/// Thread-safe.
class BoundedCalls {
 public:
  /// Must own all that it uses: it may go on when nobody waits for it any more.
  using Work = std::function<absl::Status(CallProgress& progress)>;

  /// A call that does not get on for `patience` is given up. Where as many as `most_stuck` that were given up have not come back,
  /// there are no further ones.
  explicit BoundedCalls(std::chrono::milliseconds patience, std::size_t most_stuck = 8)
      : patience_(patience), most_stuck_(most_stuck) {}

  /// Calls `work` on a thread of its own, and returns its result; Unavailable where it does not get on; Cancelled soon after
  /// `cancel` is set, which may be null.
  absl::Status run(Work work, const std::atomic<bool>* cancel) const;

 private:
  const std::chrono::milliseconds patience_;
  const std::size_t most_stuck_;
  const std::shared_ptr<std::atomic<std::size_t>> stuck_ = std::make_shared<std::atomic<std::size_t>>(0);
};

}  // namespace curvecast::server
