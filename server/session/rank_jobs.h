// Grows the ranked candidates of sessions in the background, for views that found too few.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/progressive/rank_tree.h"
#include "server/base/crew.h"
#include "server/session/improvement_jobs.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// What a view lacks of the candidates that there are.
struct LackingRanks {
  std::vector<ChunkId> chunks;
  std::size_t points = 0;  // that the view shows without them
};
/// Looks what a view lacks of a tree. Called by one thread at a time.
using RankDemand = std::function<LackingRanks(const std::shared_ptr<const RankTree>& tree)>;

/// Thread-safe. Threads of low priority grow the candidates of one session after the other.
class RankJobs {
 public:
  /// Called without locks by the thread that grows, when a session's candidates have grown or will not.
  using OnDone = std::function<void(const Session& session)>;

  /// `threads`: how many work on the candidates of a session, at least 1.
  RankJobs(int threads, OnDone on_done, std::shared_ptr<spdlog::logger> log);

  /// Asks for what a view lacks, instead of what the client `source` asked for before: views that were overtaken get nothing
  /// made. Level by level, until nothing lacks any more, or some time has passed and there is more to be seen: then on_done is
  /// called, and whoever still lacks something asks again. Returns whether that is done, so that on_done is called afterwards:
  /// false when there is no room for more, or after stop().
  bool request(const std::shared_ptr<const Session>& session, std::uint64_t source, RankDemand demand);
  /// Cancels everything and joins the threads; refuses what comes later.
  void stop() { jobs_.stop(); }

 private:
  Improvement improve(const Session& session, const Demands<RankDemand>& demands, const std::atomic<bool>& cancel);

  const std::shared_ptr<spdlog::logger> log_;
  Crew crew_;
  ImprovementJobs<RankDemand> jobs_;  // last: they use the others
};

}  // namespace curvecast::server
