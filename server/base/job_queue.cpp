#include "server/base/job_queue.h"

#include <absl/cleanup/cleanup.h>

#include <algorithm>
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

absl::StatusOr<std::uint64_t> JobQueue::submit(std::function<void()> job, const Claim& claim) {
  const MutexLock lock(mutex_);
  if (stopped_) return absl::UnavailableError("the server is shutting down");
  if (places_.size() >= options_.max_waiting) {
    ++refused_;
    return absl::ResourceExhaustedError("the server is busy; try again later");
  }
  if (lanes_ >= forget_at_) forget_idle();
  auto found = callers_.find(claim.caller);
  if (found == callers_.end()) found = callers_.emplace(std::string(claim.caller), Caller()).first;
  Caller& caller = found->second;
  if (caller.waiting >= options_.max_waiting_of_one) {
    ++refused_;
    return absl::ResourceExhaustedError("too many of this client's requests wait already; try again later");
  }
  if (caller.waiting == 0 && caller.running == 0) caller.used = std::max(caller.used, turn_);
  Lane& lane = lane_of(claim, caller);
  if (lane.waiting.empty() && lane.running == 0) lane.used = std::max(lane.used, caller.turn);
  const Nanoseconds at = lane.used + claim.expected;
  lane.waiting.emplace(std::pair(at, next_ticket_), Job{std::move(job), claim.expected});
  places_[next_ticket_] = {&caller, &lane, at};
  ++caller.waiting;
  wake_.notify_one();
  return next_ticket_++;
}

JobQueue::Lane& JobQueue::lane_of(const Claim& claim, Caller& caller) {
  const auto found = caller.lanes.find(claim.connection);
  if (found != caller.lanes.end()) return found->second;
  ++lanes_;
  return caller.lanes.emplace(std::string(claim.connection), Lane()).first->second;
}

bool JobQueue::withdraw(std::uint64_t ticket) {
  Job job;  // outlives the lock: what it holds may take its time to go
  const MutexLock lock(mutex_);
  const auto found = places_.find(ticket);
  if (found == places_.end()) return false;
  const Place place = found->second;
  places_.erase(found);
  job = std::move(place.lane->waiting.extract(std::pair(place.at, ticket)).mapped());
  --place.caller->waiting;
  return true;
}

std::size_t JobQueue::waiting() const {
  const MutexLock lock(mutex_);
  return places_.size();
}

std::size_t JobQueue::overdue() const {
  const Nanoseconds now = options_.clock();
  const MutexLock lock(mutex_);
  const auto count =
      std::count_if(running_.begin(), running_.end(), [&](const auto& job) { return is_overdue(job.second, now); });
  return static_cast<std::size_t>(count);
}

void JobQueue::tell_overdue(const std::function<void(const std::string&, Nanoseconds)>& tell) {
  const Nanoseconds now = options_.clock();
  const MutexLock lock(mutex_);
  for (auto& [ticket, job] : running_) {
    if (!is_overdue(job, now) || std::exchange(job.was_told, true)) continue;
    tell(job.caller, now - job.start);
  }
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

JobQueue::Order JobQueue::order_of(const Share& share, Jobs::iterator job) {
  return {share.running, share.used + job->second.expected, job->first.second};
}

JobQueue::Turn JobQueue::next_of(const std::string& name, Caller& caller, bool may_be_long) {
  Turn best;
  for (auto& [connection, lane] : caller.lanes) {
    const Jobs::iterator job = std::find_if(lane.waiting.begin(), lane.waiting.end(),
                                            [&](const auto& entry) { return may_be_long || !is_long(entry.second.expected); });
    if (job == lane.waiting.end()) continue;
    if (best.lane == nullptr || order_of(lane, job) < order_of(*best.lane, best.job)) best = {name, &caller, &lane, job};
  }
  return best;
}

JobQueue::Turn JobQueue::next_turn() {
  const auto long_ones =
      std::count_if(running_.begin(), running_.end(), [&](const auto& entry) { return is_long(entry.second.expected); });
  const bool may_be_long = long_ones < std::max(1, options_.workers - 1);
  Turn best;
  for (auto& [name, caller] : callers_) {
    if (caller.waiting == 0 || caller.running >= options_.max_running_of_one) continue;
    Turn next = next_of(name, caller, may_be_long);
    if (next.lane == nullptr) continue;
    if (best.lane == nullptr || order_of(caller, next.job) < order_of(*best.caller, best.job)) best = std::move(next);
  }
  return best;
}

void JobQueue::forget_idle() {
  const auto is_idle = [](const Share& share, Nanoseconds turn) { return share.running == 0 && share.used <= turn; };
  lanes_ = 0;
  for (auto& [name, caller] : callers_) {
    const Nanoseconds turn = caller.turn;
    std::erase_if(caller.lanes, [&](const auto& entry) { return entry.second.waiting.empty() && is_idle(entry.second, turn); });
    lanes_ += caller.lanes.size();
  }
  const Nanoseconds turn = turn_;
  std::erase_if(callers_, [&](const auto& entry) { return entry.second.lanes.empty() && is_idle(entry.second, turn); });
  forget_at_ = std::max<std::size_t>(64, 2 * std::max(lanes_, callers_.size()));
}

void JobQueue::work() {
  if (options_.low_priority) lower_priority();
  MutexLock lock(mutex_);
  while (true) {
    Turn turn = next_turn();
    while (turn.lane == nullptr && !(stopped_ && places_.empty())) {
      wake_.wait(mutex_);
      turn = next_turn();
    }
    if (turn.lane == nullptr) return;
    // They stay where they are while they have a job running.
    Caller& caller = *turn.caller;
    Lane& lane = *turn.lane;
    auto taken = lane.waiting.extract(turn.job);
    const std::uint64_t ticket = taken.key().second;
    std::function<void()> job = std::move(taken.mapped().run);
    places_.erase(ticket);
    --caller.waiting;
    for (Share* share : {static_cast<Share*>(&caller), static_cast<Share*>(&lane)}) ++share->running;
    const Nanoseconds start = options_.clock();
    running_[ticket] = {turn.name, start, taken.mapped().expected};
    turn_ = std::max(turn_, caller.used);
    caller.turn = std::max(caller.turn, lane.used);
    lock.unlock();
    job();
    job = nullptr;  // before the lock, for the same reason as above
    const Nanoseconds spent = options_.clock() - start;
    lock.lock();
    for (Share* share : {static_cast<Share*>(&caller), static_cast<Share*>(&lane)}) {
      --share->running;
      share->used += spent;
    }
    running_.erase(ticket);
    // Once all have what they asked for, nobody owes another one.
    if (places_.empty() && running_.empty()) {
      callers_.clear();
      lanes_ = 0;
      turn_ = {};
    }
    const bool others_waited_for_it = options_.max_running_of_one < options_.workers || is_long(taken.mapped().expected);
    if (others_waited_for_it || stopped_) wake_.notify_all();
  }
}

}  // namespace curvecast::server
