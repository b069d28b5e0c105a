// The bytes of answers that wait in memory until clients read them.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <cstdint>

namespace curvecast::server {

/// Counts the bytes of a server's frames and point sets that wait or are being sent, and limits them. Thread-safe.
class QueuedBytes {
 public:
  /// Limits the bytes to `most`.
  explicit QueuedBytes(std::uint64_t most) : most_(static_cast<std::int64_t>(most)) {}

  /// Adds bytes; fewer wait where `bytes` is negative.
  void add(std::int64_t bytes) { bytes_.fetch_add(bytes, std::memory_order_relaxed); }

  /// ResourceExhausted while there are too many: nothing more should be made.
  absl::Status check() const {
    if (bytes_.load(std::memory_order_relaxed) <= most_) return absl::OkStatus();
    return absl::ResourceExhaustedError("too much waits to be read by its clients; try again later");
  }

 private:
  const std::int64_t most_;
  std::atomic<std::int64_t> bytes_ = 0;
};

}  // namespace curvecast::server
