// What bursts of work leave behind in the allocator.
#pragma once

#include <chrono>
#include <cstdint>

namespace curvecast::server {

/// glibc keeps what was freed in pieces for whoever comes next, of every thread's own: after a crowd, or calls that fail, that is
/// memory for ever. Not thread-safe.
class SpareMemory {
 public:
  /// Gives it back to the system, where the process has 32 MiB more than when it was smallest; at most every ten seconds, for who
  /// allocates then waits, for milliseconds, and less often while it brings nothing: what is in use now may be spare later.
  /// Sooner where it has grown by 128 MiB since: in a small container that is much of what there is. To be called now and then.
  void give_back(std::chrono::steady_clock::time_point now);

 private:
  static constexpr std::chrono::seconds kShortestPause{1}, kPause{10}, kLongestPause{160};

  std::uint64_t least_ = 0;  // bytes; 0: not yet looked
  std::uint64_t left_ = 0;   // ... when it last gave back
  std::chrono::steady_clock::time_point gave_back_ = {};
  std::chrono::seconds pause_ = kPause;
};

}  // namespace curvecast::server
