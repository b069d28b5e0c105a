#include "server/frame/frame_cache.h"

#include <absl/cleanup/cleanup.h>

#include <utility>
#include <vector>

namespace curvecast::server {

absl::StatusOr<Answer> FrameCache::get(const Key& key, const std::function<absl::StatusOr<Answer>()>& make) {
  const auto entry = std::make_shared<Entry>();
  {
    MutexLock lock(mutex_);
    for (auto found = entries_.find(key); found != entries_.end(); found = entries_.find(key)) {
      const std::shared_ptr<Entry> other = found->second;
      if (other->answer != nullptr) {
        ages_.splice(ages_.end(), ages_, other->age);
        other->used = Clock::now();
        lock.unlock();
        ++shared_;
        return *other->answer;
      }
      made_.wait(mutex_);
    }
    entries_.emplace(key, entry);
  }
  // Whatever becomes of the answer, the threads that wait for it go on.
  const absl::Cleanup finish = [&] {
    const MutexLock lock(mutex_);
    if (entry->answer == nullptr) entries_.erase(key);
    made_.notify_all();
  };
  absl::StatusOr<Answer> made = make();
  if (made.ok() && made->follow_up == FollowUp::kNone) keep(key, *entry, *made);
  return made;
}

void FrameCache::keep(const Key& key, Entry& entry, const Answer& answer) {
  auto kept = std::make_shared<const Answer>(answer);
  const std::size_t bytes = answer.frame.ByteSizeLong();
  std::vector<std::shared_ptr<Entry>> gone;  // after the lock
  const MutexLock lock(mutex_);
  entry.answer = std::move(kept);
  entry.bytes = bytes;
  entry.used = Clock::now();
  entry.age = ages_.insert(ages_.end(), key);
  bytes_ += bytes;
  while (bytes_ > kMostBytes) gone.push_back(drop_oldest());
}

void FrameCache::forget_before(Clock::time_point moment) {
  std::vector<std::shared_ptr<Entry>> gone;  // after the lock
  const MutexLock lock(mutex_);
  while (!ages_.empty() && entries_.at(ages_.front())->used < moment) gone.push_back(drop_oldest());
}

std::shared_ptr<FrameCache::Entry> FrameCache::drop_oldest() {
  const auto oldest = entries_.find(ages_.front());
  std::shared_ptr<Entry> entry = std::move(oldest->second);
  bytes_ -= entry->bytes;
  entries_.erase(oldest);
  ages_.pop_front();
  return entry;
}

}  // namespace curvecast::server
