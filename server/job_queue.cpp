#include "server/job_queue.h"

#include <absl/cleanup/cleanup.h>

#include <utility>

namespace curvecast::server {

JobQueue::JobQueue(int workers, std::size_t max_pending) : max_pending_(max_pending) {
  absl::Cleanup join = [this] { stop(); };  // a thread that cannot be made throws
  for (int i = 0; i < workers; ++i) workers_.emplace_back([this] { work(); });
  std::move(join).Cancel();
}

JobQueue::~JobQueue() { stop(); }

absl::StatusOr<std::uint64_t> JobQueue::submit(std::function<void()> job) {
  const std::lock_guard lock(mutex_);
  if (stopped_) return absl::UnavailableError("the server is shutting down");
  if (pending_.size() >= max_pending_) return absl::ResourceExhaustedError("the server is busy; try again later");
  pending_.emplace(next_ticket_, std::move(job));
  wake_.notify_one();
  return next_ticket_++;
}

bool JobQueue::withdraw(std::uint64_t ticket) {
  std::function<void()> job;  // outlives the lock: what it holds may take its time to go
  const std::lock_guard lock(mutex_);
  auto node = pending_.extract(ticket);
  if (node.empty()) return false;
  job = std::move(node.mapped());
  return true;
}

std::size_t JobQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return pending_.size();
}

void JobQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    wake_.notify_all();
  }
  const std::lock_guard lock(join_mutex_);
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
}

void JobQueue::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopped_ || !pending_.empty(); });
    if (pending_.empty()) return;
    std::function<void()> job = std::move(pending_.extract(pending_.begin()).mapped());
    lock.unlock();
    job();
    job = nullptr;  // before the lock, for the same reason as above
    lock.lock();
  }
}

}  // namespace curvecast::server
