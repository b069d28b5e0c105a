#include "server/base/retry_queue.h"

#include <algorithm>
#include <utility>

#include "server/base/status_from_exceptions.h"

namespace curvecast::server {
namespace {

/// Whether another try may succeed.
bool may_pass(const absl::Status& status) {
  return !absl::IsCancelled(status) && !absl::IsDataLoss(status) && !absl::IsInvalidArgument(status);
}

}  // namespace

RetryQueue::RetryQueue(Hooks hooks, Clock::duration first_wait, Clock::duration longest_wait)
    : hooks_(std::move(hooks)), first_wait_(first_wait), longest_wait_(longest_wait), thread_([this] { run(); }) {}

RetryQueue::~RetryQueue() { stop(); }

void RetryQueue::stop() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  const MutexLock lock(join_mutex_);
  if (thread_.joinable()) thread_.join();
}

void RetryQueue::put(const std::string& id, Attempt attempt) {
  const MutexLock lock(mutex_);
  if (is_stopping_) return;
  const auto [entry, is_new] = entries_.try_emplace(id);
  entry->second.attempt.swap(attempt);  // one that has failed is tried when it would have been
  entry->second.is_let_go = false;
  if (is_new) entry->second.due = Clock::now();
  changed_.notify_all();
}  // the old attempt is destroyed after the lock is released, for what it holds may take its time to go

RetryQueue::Found RetryQueue::withdraw(const std::string& id) {
  const MutexLock lock(mutex_);
  const bool was_waiting = entries_.erase(id) > 0;
  if (trying_ != id) return was_waiting ? Found::kWaiting : Found::kNothing;
  return is_withdrawn_.exchange(true) && !was_waiting ? Found::kWithdrawn : Found::kBeingTried;
}

bool RetryQueue::is_withdrawn(const std::string& id) const {
  const MutexLock lock(mutex_);
  return trying_ == id && is_withdrawn_;
}

void RetryQueue::wait_until_undone(const std::string& id) {
  const MutexLock lock(mutex_);
  while (trying_ == id && is_withdrawn_) changed_.wait(mutex_);
}

void RetryQueue::let_go(const std::string& id) {
  const MutexLock lock(mutex_);
  if (trying_ == id) is_let_go_ = true;
  const auto entry = entries_.find(id);
  if (entry == entries_.end()) return;
  entry->second.is_let_go = true;
  // That it failed has been told.
  if (entry->second.wait > Clock::duration::zero()) {
    if (hooks_.on_tried) hooks_.on_tried(id, absl::UnavailableError("it had to leave the memory"), true);
    entries_.erase(entry);
  }
}

bool RetryQueue::has(const std::string& id) const {
  const MutexLock lock(mutex_);
  return entries_.contains(id) || (trying_ == id && !id.empty());
}

std::vector<std::string> RetryQueue::ids() const {
  const MutexLock lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [id, entry] : entries_) ids.push_back(id);
  if (!trying_.empty() && !entries_.contains(trying_)) ids.push_back(trying_);
  return ids;
}

std::size_t RetryQueue::size() const {
  const MutexLock lock(mutex_);
  return entries_.size() + (trying_.empty() || entries_.contains(trying_) ? 0 : 1);
}

std::map<std::string, RetryQueue::Entry>::iterator RetryQueue::first_due() {
  return std::min_element(entries_.begin(), entries_.end(),
                          [](const auto& a, const auto& b) { return a.second.due < b.second.due; });
}

void RetryQueue::run() {
  const MutexLock lock(mutex_);
  for (;;) {
    const auto first = first_due();
    if (first == entries_.end()) {
      if (is_stopping_) return;
      changed_.wait(mutex_);
    } else if (!is_stopping_ && first->second.due > Clock::now()) {
      changed_.wait_until(mutex_, first->second.due);
    } else {
      try_next(first->first);
    }
  }
}

void RetryQueue::try_next(const std::string& id) {
  auto node = entries_.extract(id);
  Entry entry = std::move(node.mapped());
  trying_ = node.key();
  is_withdrawn_ = false;
  is_let_go_ = entry.is_let_go;
  mutex_.unlock();
  const absl::Status status = status_from_exceptions([&] { return entry.attempt(is_withdrawn_); });
  mutex_.lock();
  const std::string tried = std::exchange(trying_, {});
  if (is_withdrawn_) {
    if (hooks_.undo) hooks_.undo(tried);
  } else {
    const auto newer = entries_.find(tried);
    const bool is_tried_again = !status.ok() && may_pass(status) && !is_stopping_ && !is_let_go_;
    if (hooks_.on_tried) hooks_.on_tried(tried, status, !status.ok() && !is_tried_again && newer == entries_.end());
    if (is_tried_again) {
      entry.wait = std::clamp(2 * entry.wait, first_wait_, longest_wait_);
      entry.due = Clock::now() + entry.wait;
      if (newer != entries_.end()) entry.attempt.swap(newer->second.attempt);
      entries_.insert_or_assign(tried, std::move(entry));
    }
  }
  changed_.notify_all();
  // What the attempt keeps may take its time to go.
  mutex_.unlock();
  entry.attempt = nullptr;
  mutex_.lock();
}

}  // namespace curvecast::server
