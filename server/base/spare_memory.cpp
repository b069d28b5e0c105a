#include "server/base/spare_memory.h"

#include <malloc.h>

#include <algorithm>

#include "server/base/process_usage.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kWorthwhile = 32 << 20, kMuch = 128 << 20;  // bytes

}  // namespace

void SpareMemory::give_back(std::chrono::steady_clock::time_point now) {
  const std::uint64_t bytes = anonymous_bytes();
  if (least_ == 0 || bytes < least_) least_ = bytes;
  if (bytes < least_ + kWorthwhile) return;
  if (bytes >= left_ + kMuch) {
    pause_ = kShortestPause;
  } else if (bytes >= left_ + kWorthwhile) {
    pause_ = std::min(pause_, kPause);
  }
  if (now < gave_back_ + pause_) return;
  ::malloc_trim(0);
  gave_back_ = now;
  left_ = anonymous_bytes();
  pause_ = bytes >= left_ + kWorthwhile ? kPause : std::min(2 * pause_, kLongestPause);
}

}  // namespace curvecast::server
