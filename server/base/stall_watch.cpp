#include "server/base/stall_watch.h"

#include <utility>

namespace curvecast::server {

void StallWatch::begin(const void* call, End end) {
  const MutexLock lock(mutex_);
  messages_[call] = {Clock::now(), std::move(end)};
}

void StallWatch::done(const void* call) {
  const MutexLock lock(mutex_);
  messages_.erase(call);
}

std::size_t StallWatch::end_begun_before(Clock::time_point moment) {
  const MutexLock lock(mutex_);
  std::size_t ended = 0;
  for (auto& [call, message] : messages_) {
    if (message.begun >= moment || message.end == nullptr) continue;
    std::exchange(message.end, nullptr)(status_);
    ++ended;
  }
  return ended;
}

}  // namespace curvecast::server
