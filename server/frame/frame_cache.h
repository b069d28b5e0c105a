// Frames that several clients want are made once.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "server/frame/make_frame.h"

namespace curvecast::server {

/// Thread-safe. What it keeps holds its session's curve in memory.
class FrameCache {
 public:
  using Clock = std::chrono::steady_clock;

  /// All that a frame depends on.
  struct Key {
    std::shared_ptr<const SurfaceCurve> curve;
    std::array<std::uint64_t, 2> sample{};  // Sample::fingerprint
    std::uint64_t points = 0;               // of an automatic budget
    std::uint64_t held = 0;                 // digest of what the client holds; 0: nothing
    std::uint64_t first_bytes = 0;
    auto operator<=>(const Key&) const = default;
  };

  /// What `make` gives, or gave a short while ago; waits where somebody is at it. Answers that are to be improved, and errors,
  /// are for those who made them only.
  absl::StatusOr<Answer> get(const Key& key, const std::function<absl::StatusOr<Answer>()>& make);

  /// Forgets what has not been asked for since a moment.
  void forget_before(Clock::time_point moment);
  /// How many answers were there already.
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

  void keep(const Key& key, Entry& entry, const Answer& answer);
  /// Drops the one used longest ago; its memory goes with what is returned. With the lock.
  std::shared_ptr<Entry> drop_oldest();

  std::atomic<std::uint64_t> shared_ = 0;
  std::mutex mutex_;
  std::condition_variable made_;
  Entries entries_;
  std::list<Key> ages_;  // those used longest ago first
  std::size_t bytes_ = 0;
};

}  // namespace curvecast::server
