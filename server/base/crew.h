// Threads of low priority that share long work.
#pragma once

#include <cstddef>
#include <functional>

#include "server/base/job_queue.h"

namespace curvecast::server {

/// Some threads that help whoever has work that can be shared, one after the other. Thread-safe.
class Crew {
 public:
  /// `helpers`: threads besides those that call; may be 0.
  explicit Crew(int helpers);

  /// Calls work(i) for all i below n, on the calling thread and those of the helpers that have nothing else to do, and returns
  /// when all are done. After stop() the calling thread does it alone. `work` must not throw.
  void for_all(std::size_t n, const std::function<void(std::size_t i)>& work);
  /// Joins the helpers.
  void stop() { queue_.stop(); }

 private:
  const int helpers_;
  JobQueue queue_;
};

}  // namespace curvecast::server
