// Which of a stream's views were answered.
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

  /// Views are numbered upwards; a number that is not is none.
  void received(std::uint64_t sequence);
  /// A frame was sent; another one for the same view changes nothing. Numbers never descend.
  void answered(std::uint64_t sequence);

 private:
  Metrics& metrics_;
  Mutex mutex_;
  std::deque<std::uint64_t> open_ ABSL_GUARDED_BY(mutex_);  // ascending
};

}  // namespace curvecast::server
