// Counts which of a stream's views were answered.
#pragma once

#include <cstdint>
#include <deque>

#include "core/base/mutex.h"
#include "server/engine/metrics.h"

namespace curvecast::server {

/// Thread-safe. Counts one conversation into the metrics: each view received is in the end either answered or overtaken.
class ViewTally {
 public:
  explicit ViewTally(Metrics& metrics);
  /// The conversation is over: what has not been answered never will be.
  ~ViewTally();
  ViewTally(const ViewTally&) = delete;
  ViewTally& operator=(const ViewTally&) = delete;

  /// Counts a view. Views are numbered upwards; one with a number that is not above the last one is not counted.
  void received(std::uint64_t sequence);
  /// Counts a frame that was sent; another one for the same view changes nothing. Precondition: the numbers never descend.
  void answered(std::uint64_t sequence);

 private:
  Metrics& metrics_;
  Mutex mutex_;
  std::deque<std::uint64_t> open_ ABSL_GUARDED_BY(mutex_);  // ascending
};

}  // namespace curvecast::server
