// Grows the ranked candidates of sessions in the background, for views that found too few.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <span>

#include "core/progressive/rank_chunk.h"
#include "server/session/improvement_jobs.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. One thread of low priority grows the candidates of one session after the other.
class RankJobs {
 public:
  /// Called without locks by the thread that grows, when a session's candidates have grown or will not.
  using OnDone = std::function<void(const Session& session)>;

  RankJobs(OnDone on_done, std::shared_ptr<spdlog::logger> log);

  /// Asks for chunks that were found lacking; those of a session that waits for its turn are made together. Returns whether they
  /// are being made, so that on_done is called afterwards: false when there is no room for more, or after stop().
  bool request(const std::shared_ptr<const Session>& session, std::span<const ChunkId> lacking);
  /// Cancels everything and joins the thread; refuses what comes later.
  void stop() { jobs_.stop(); }

 private:
  using Chunks = std::set<ChunkId>;

  Improvement grow(const Session& session, const Chunks& lacking, const std::atomic<bool>& cancel) const;

  const std::shared_ptr<spdlog::logger> log_;
  ImprovementJobs<Chunks> jobs_;  // last: they use the others
};

}  // namespace curvecast::server
