// The bytes of answers that wait in memory until clients read them.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <string>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Counts the bytes of a server's frames and point sets that wait or are being sent, and limits them: as long as less than half
/// of what there may be waits, whoever wants it has it; beyond, a caller may have no more than a sixteenth, and begin one answer
/// where it has nothing. So who does not read is refused, not those who do. Thread-safe.
class QueuedBytes {
 public:
  /// Limits the bytes to `most`.
  explicit QueuedBytes(std::uint64_t most) : most_(static_cast<std::int64_t>(most)) {}

  /// Adds bytes of a caller; fewer wait where `bytes` is negative.
  void add(const std::string& caller, std::int64_t bytes) ABSL_LOCKS_EXCLUDED(mutex_);

  /// ResourceExhausted while too many wait, of this caller or of all: nothing more should be made for it.
  absl::Status check(const std::string& caller) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether more than half of what may wait does.
  bool is_half_full() const ABSL_LOCKS_EXCLUDED(mutex_);
  std::uint64_t bytes() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// How often check() has refused.
  std::uint64_t refused() const { return refused_; }

 private:
  static constexpr int kShares = 16;  // of which each caller has one

  const std::int64_t most_;
  mutable std::atomic<std::uint64_t> refused_ = 0;
  mutable Mutex mutex_;
  std::int64_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::int64_t> of_caller_ ABSL_GUARDED_BY(mutex_);  // of whom something waits
};

}  // namespace curvecast::server
