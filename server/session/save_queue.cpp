#include "server/session/save_queue.h"

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

SaveQueue::SaveQueue(Hooks hooks, Clock::duration first_wait, Clock::duration longest_wait)
    : hooks_(std::move(hooks)), first_wait_(first_wait), longest_wait_(longest_wait), thread_([this] { run(); }) {}

SaveQueue::~SaveQueue() { stop(); }

void SaveQueue::stop() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  const MutexLock lock(join_mutex_);
  if (thread_.joinable()) thread_.join();
}

void SaveQueue::put(const Session& session) {
  std::shared_ptr<const Session> copy = std::make_shared<const Session>(session);
  const MutexLock lock(mutex_);
  if (is_stopping_) return;
  const auto [entry, is_new] = entries_.try_emplace(session.id);
  entry->second.session.swap(copy);  // one that has failed is tried when it would have been
  entry->second.is_let_go = false;
  if (is_new) entry->second.due = Clock::now();
  changed_.notify_all();
}

SaveQueue::Found SaveQueue::withdraw(const std::string& id) {
  const MutexLock lock(mutex_);
  const bool was_waiting = entries_.erase(id) > 0;
  if (saving_ != id) return was_waiting ? Found::kWaiting : Found::kNothing;
  return std::exchange(is_withdrawn_, true) && !was_waiting ? Found::kWithdrawn : Found::kBeingSaved;
}

bool SaveQueue::is_withdrawn(const std::string& id) const {
  const MutexLock lock(mutex_);
  return saving_ == id && is_withdrawn_;
}

void SaveQueue::wait_until_undone(const std::string& id) {
  const MutexLock lock(mutex_);
  while (saving_ == id && is_withdrawn_) changed_.wait(mutex_);
}

void SaveQueue::let_go(const std::string& id) {
  const MutexLock lock(mutex_);
  if (saving_ == id) is_let_go_ = true;
  const auto entry = entries_.find(id);
  if (entry == entries_.end()) return;
  entry->second.is_let_go = true;
  // That it failed has been told.
  if (entry->second.wait > Clock::duration::zero()) {
    hooks_.on_tried(id, absl::UnavailableError("it had to leave the memory"), true);
    entries_.erase(entry);
  }
}

bool SaveQueue::has(const std::string& id) const {
  const MutexLock lock(mutex_);
  return entries_.contains(id) || (saving_ == id && !id.empty());
}

std::vector<std::string> SaveQueue::ids() const {
  const MutexLock lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [id, entry] : entries_) ids.push_back(id);
  if (!saving_.empty() && !entries_.contains(saving_)) ids.push_back(saving_);
  return ids;
}

std::size_t SaveQueue::size() const {
  const MutexLock lock(mutex_);
  return entries_.size() + (saving_.empty() || entries_.contains(saving_) ? 0 : 1);
}

std::map<std::string, SaveQueue::Entry>::iterator SaveQueue::first_due() {
  return std::min_element(entries_.begin(), entries_.end(),
                          [](const auto& a, const auto& b) { return a.second.due < b.second.due; });
}

void SaveQueue::run() {
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

void SaveQueue::try_next(const std::string& id) {
  auto node = entries_.extract(id);
  Entry entry = std::move(node.mapped());
  saving_ = node.key();
  is_withdrawn_ = false;
  is_let_go_ = entry.is_let_go;
  mutex_.unlock();
  const absl::Status status = status_from_exceptions([&] { return hooks_.save(*entry.session); });
  mutex_.lock();
  const std::string saved = std::exchange(saving_, {});
  if (is_withdrawn_) {
    hooks_.undo(saved);
  } else {
    const auto newer = entries_.find(saved);
    const bool is_tried_again = !status.ok() && may_pass(status) && !is_stopping_ && !is_let_go_;
    hooks_.on_tried(saved, status, !status.ok() && !is_tried_again && newer == entries_.end());
    if (is_tried_again) {
      entry.wait = std::clamp(2 * entry.wait, first_wait_, longest_wait_);
      entry.due = Clock::now() + entry.wait;
      if (newer != entries_.end()) entry.session.swap(newer->second.session);
      entries_.insert_or_assign(saved, std::move(entry));
    }
  }
  changed_.notify_all();
  // What the copy keeps may take its time to go.
  mutex_.unlock();
  entry.session.reset();
  mutex_.lock();
}

}  // namespace curvecast::server
