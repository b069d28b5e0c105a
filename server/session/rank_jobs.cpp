#include "server/session/rank_jobs.h"

#include <spdlog/logger.h>

#include <string>
#include <utility>
#include <vector>

#include "core/base/stopwatch.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::server {

RankJobs::RankJobs(OnDone on_done, std::shared_ptr<spdlog::logger> log)
    : log_(std::move(log)),
      jobs_({.improve = [this](const Session& session, const Chunks& lacking,
                               const std::atomic<bool>& cancel) { return grow(session, lacking, cancel); },
             .on_done = [on_done = std::move(on_done)](const Session& session, bool /*is_better*/) { on_done(session); }}) {}

bool RankJobs::request(const std::shared_ptr<const Session>& session, std::span<const ChunkId> lacking) {
  if (session->candidates->is_full()) return false;
  return jobs_.request(session, [&](Chunks& chunks) { chunks.insert(lacking.begin(), lacking.end()); });
}

Improvement RankJobs::grow(const Session& session, const Chunks& lacking, const std::atomic<bool>& cancel) const {
  Stopwatch watch;
  const std::vector<ChunkId> chunks(lacking.begin(), lacking.end());
  const absl::Status status =
      status_from_exceptions([&] { return session.candidates->grow(chunks, {.cancel = &cancel, .threads = 1}); });
  if (status.ok()) {
    log_->info("session {} has more ranked candidates in {:.3f} s", session.id, watch.lap());
  } else if (!cancel) {
    log_->warn("session {} has no more ranked candidates: {}", session.id, std::string(status.message()));
  }
  return {.is_better = status.ok()};
}

}  // namespace curvecast::server
