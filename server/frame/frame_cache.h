// Shares frames that several clients want.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>

#include "core/base/mutex.h"
#include "server/frame/make_frame.h"

namespace curvecast::server {

/// Keeps the newest frames, up to a number of bytes. A frame keeps its session's curve in memory. Thread-safe.
class FrameCache {
 public:
  using Clock = std::chrono::steady_clock;

  /// All that a frame depends on.
  struct Key {
    std::shared_ptr<const SurfaceCurve> curve;
    std::array<std::uint64_t, 2> request{};  // PointSetRequest::fingerprint
    std::uint64_t points = 0;                // of an automatic budget
    std::uint64_t reference = 0;             // ReferenceFrame::digest of what the client holds; 0: nothing
    std::uint64_t first_bytes = 0;
    auto operator<=>(const Key&) const = default;
  };

  /// Returns the answer of that key, or has `make` make it; waits where another thread makes it. Errors, and answers that have a
  /// follow-up, are returned to the caller that made them and not kept.
  absl::StatusOr<Answer> get(const Key& key, const std::function<absl::StatusOr<Answer>()>& make) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Drops the answers that were last asked for before a moment.
  void forget_before(Clock::time_point moment) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns how many answers were found in the cache.
  std::uint64_t shared() const { return shared_; }

 private:
  static constexpr std::size_t kMostBytes = std::size_t{16} << 20;  // of frames

  struct Entry {
    std::shared_ptr<const Answer> answer;  // null: in the making
    std::size_t bytes = 0;
    Clock::time_point used;
    std::list<Key>::iterator age;  // in ages_, with an answer
  };
  using Entries = std::map<Key, std::shared_ptr<Entry>>;

  void keep(const Key& key, Entry& entry, const Answer& answer) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Drops the entry used longest ago. Returns it, so that its memory is freed without the lock.
  std::shared_ptr<Entry> drop_oldest() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  std::atomic<std::uint64_t> shared_ = 0;
  Mutex mutex_;
  CondVar made_;
  Entries entries_ ABSL_GUARDED_BY(mutex_);
  std::list<Key> ages_ ABSL_GUARDED_BY(mutex_);  // those used longest ago first
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
