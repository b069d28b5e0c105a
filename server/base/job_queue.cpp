#include "server/base/job_queue.h"

#include <absl/cleanup/cleanup.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "server/base/low_priority.h"

namespace curvecast::server {

JobQueue::JobQueue(Options options) : options_(std::move(options)) {
  absl::Cleanup join = [this] { stop(); };  // a thread that cannot be made throws
  {
    const MutexLock lock(join_mutex_);
    for (int i = 0; i < options_.workers; ++i) workers_.emplace_back([this] { work(); });
  }
  std::move(join).Cancel();
}

JobQueue::~JobQueue() { stop(); }

absl::StatusOr<std::uint64_t> JobQueue::submit(std::function<void()> job, std::string_view whose) {
  const MutexLock lock(mutex_);
  if (stopped_) return absl::UnavailableError("the server is shutting down");
  if (waiting_ >= options_.max_waiting) return absl::ResourceExhaustedError("the server is busy; try again later");
  auto lane = lanes_.find(whose);
  if (lane == lanes_.end()) {
    forget_idle();
    lane = lanes_.emplace(std::string(whose), Lane{.waiting = {}, .used = turn_}).first;
  }
  Lane& mine = lane->second;
  if (mine.waiting.size() >= options_.max_waiting_of_one) {
    return absl::ResourceExhaustedError("too many of this client's requests wait already; try again later");
  }
  if (mine.waiting.empty() && mine.running == 0) mine.used = std::max(mine.used, turn_);
  mine.waiting.emplace(next_ticket_, std::move(job));
  ++waiting_;
  wake_.notify_one();
  return next_ticket_++;
}

bool JobQueue::withdraw(std::uint64_t ticket) {
  std::function<void()> job;  // outlives the lock: what it holds may take its time to go
  const MutexLock lock(mutex_);
  for (auto& [whose, lane] : lanes_) {
    auto node = lane.waiting.extract(ticket);
    if (node.empty()) continue;
    job = std::move(node.mapped());
    --waiting_;
    return true;
  }
  return false;
}

std::size_t JobQueue::waiting() const {
  const MutexLock lock(mutex_);
  return waiting_;
}

void JobQueue::stop() {
  {
    const MutexLock lock(mutex_);
    stopped_ = true;
    wake_.notify_all();
  }
  const MutexLock lock(join_mutex_);
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
}

JobQueue::Lanes::iterator JobQueue::next_lane() {
  const auto order = [](const Lane& lane) { return std::tuple(lane.running, lane.used, lane.waiting.begin()->first); };
  auto best = lanes_.end();
  for (auto lane = lanes_.begin(); lane != lanes_.end(); ++lane) {
    if (lane->second.waiting.empty() || lane->second.running >= options_.max_running_of_one) continue;
    if (best == lanes_.end() || order(lane->second) < order(best->second)) best = lane;
  }
  return best;
}

void JobQueue::forget_idle() {
  if (lanes_.size() < forget_at_) return;
  std::erase_if(lanes_, [turn = turn_](const auto& entry) {
    const Lane& lane = entry.second;
    return lane.waiting.empty() && lane.running == 0 && lane.used <= turn;
  });
  forget_at_ = std::max<std::size_t>(64, 2 * lanes_.size());
}

void JobQueue::work() {
  if (options_.low_priority) lower_priority();
  MutexLock lock(mutex_);
  while (true) {
    Lanes::iterator lane = next_lane();
    while (lane == lanes_.end() && !(stopped_ && waiting_ == 0)) {
      wake_.wait(mutex_);
      lane = next_lane();
    }
    if (lane == lanes_.end()) return;
    Lane& mine = lane->second;  // stays where it is while it has a job running
    std::function<void()> job = std::move(mine.waiting.extract(mine.waiting.begin()).mapped());
    --waiting_;
    ++mine.running;
    ++running_;
    turn_ = std::max(turn_, mine.used);
    lock.unlock();
    const Nanoseconds start = options_.clock();
    job();
    job = nullptr;  // before the lock, for the same reason as above
    const Nanoseconds spent = options_.clock() - start;
    lock.lock();
    --mine.running;
    --running_;
    mine.used += spent;
    // Once all have what they asked for, no client owes another one.
    if (waiting_ == 0 && running_ == 0) {
      lanes_.clear();
      turn_ = {};
    }
    if (options_.max_running_of_one < options_.workers || stopped_) wake_.notify_all();
  }
}

}  // namespace curvecast::server
