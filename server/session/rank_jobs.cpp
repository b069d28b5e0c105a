#include "server/session/rank_jobs.h"

#include <spdlog/logger.h>

#include <utility>

#include "core/base/stopwatch.h"
#include "server/base/guarded.h"

namespace curvecast::server {
namespace {

// Sessions whose turn has not come. More are refused: they are asked for again with the next view.
constexpr std::size_t kMaxPending = 1024;

}  // namespace

RankJobs::RankJobs(OnDone on_done, std::shared_ptr<spdlog::logger> log)
    : on_done_(std::move(on_done)), log_(std::move(log)), queue_({.max_waiting = kMaxPending, .low_priority = true}) {}

RankJobs::~RankJobs() { stop(); }

bool RankJobs::request(const std::shared_ptr<const Session>& session, std::span<const ChunkId> lacking) {
  const std::lock_guard lock(mutex_);
  if (cancel_ || session->ranks->is_full()) return false;
  const auto [at, is_new] = waiting_.try_emplace(session->ranks.get());
  at->second.insert(lacking.begin(), lacking.end());
  if (!is_new) return true;
  if (queue_.submit([this, session] { run(session); }).ok()) return true;
  waiting_.erase(at);
  return false;
}

void RankJobs::stop() {
  cancel_ = true;
  queue_.stop();
}

void RankJobs::run(const std::shared_ptr<const Session>& session) {
  for (;;) {
    std::vector<ChunkId> lacking;
    {
      const std::lock_guard lock(mutex_);
      const auto at = waiting_.find(session->ranks.get());
      lacking.assign(at->second.begin(), at->second.end());
      at->second.clear();
      if (lacking.empty() || cancel_) {
        waiting_.erase(at);
        return;
      }
    }
    Stopwatch watch;
    // One thread, this one: any other of the pool would run at the priority of views.
    const absl::Status status = guarded([&] { return session->ranks->grow(lacking, {.cancel = &cancel_, .threads = 1}); });
    if (status.ok()) {
      log_->info("session {} has more ranked candidates in {:.3f} s", session->id, watch.lap());
    } else if (!cancel_) {
      log_->warn("session {} has no more ranked candidates: {}", session->id, std::string(status.message()));
    }
    on_done_(*session);
  }
}

}  // namespace curvecast::server
