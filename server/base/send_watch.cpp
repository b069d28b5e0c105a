#include "server/base/send_watch.h"

#include <utility>

namespace curvecast::server {

void SendWatch::begin(const void* sender, End end) {
  const MutexLock lock(mutex_);
  sends_[sender] = {Clock::now(), std::move(end)};
}

void SendWatch::done(const void* sender) {
  const MutexLock lock(mutex_);
  sends_.erase(sender);
}

std::size_t SendWatch::end_begun_before(Clock::time_point moment) {
  const absl::Status status = absl::ResourceExhaustedError(
      "you have not read what was sent to you for too long, and the server needs its memory; read faster");
  const MutexLock lock(mutex_);
  std::size_t ended = 0;
  for (auto& [sender, send] : sends_) {
    if (send.begun >= moment || send.end == nullptr) continue;
    std::exchange(send.end, nullptr)(status);
    ++ended;
  }
  return ended;
}

}  // namespace curvecast::server
