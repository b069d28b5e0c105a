// Progress, cancellation and parallelism of a long computation, passed down as one small value.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <string_view>

#include "core/base/work_limit.h"

namespace curvecast {

class MemorySource;

struct ExecutionContext {
  /// Called with the stage's name (a literal) and its fraction done in [0, 1], by one thread at a time. May be empty.
  std::function<void(std::string_view stage, double fraction)> on_progress;
  /// Set by anyone, at any time, to stop the work. May be null.
  const std::atomic<bool>* cancel = nullptr;
  /// Threads to use; 0 = one per core. Results never depend on it.
  int threads = 0;
  /// What the computation may take of the processors' time: densities are charged to it. May be null.
  WorkLimit* limit = nullptr;
  /// Asked for memory by what takes much of it: see core/base/memory_claim.h. May be null: there is enough.
  MemorySource* memory = nullptr;
  /// Shares work instead, for programs that have threads of their own for it: see core/base/for_all.h. May be empty.
  std::function<void(std::size_t n, const std::function<void(std::size_t i)>& work)> for_all = {};

  void progress(std::string_view stage, double fraction) const {
    if (on_progress) on_progress(stage, fraction);
  }
  bool cancelled() const { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }
  /// OK, or CancelledError once `cancel` is set.
  absl::Status check() const { return cancelled() ? absl::CancelledError("cancelled") : absl::OkStatus(); }
  /// As check(); DeadlineExceeded once nothing is left of `limit`.
  absl::Status check_limit() const {
    return limit != nullptr && limit->is_spent() ? absl::DeadlineExceededError("it takes too long") : check();
  }
};

}  // namespace curvecast
