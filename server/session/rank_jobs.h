// Grows the ranked candidates of sessions in the background, for views that found too few.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <vector>

#include "core/progressive/rank_chunk.h"
#include "server/base/job_queue.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. One thread of low priority; of each session one job runs or waits at most.
class RankJobs {
 public:
  /// Called, without locks, by the thread that grows when a session's candidates have grown or will not.
  using OnDone = std::function<void(const Session& session)>;

  RankJobs(OnDone on_done, std::shared_ptr<spdlog::logger> log);
  ~RankJobs();  // stop()

  /// Somebody found chunks lacking; what waits for its turn is met together. Returns whether they are being made, so that on_done
  /// is called afterwards: false when there is no room for more, or after stop().
  bool request(const std::shared_ptr<const Session>& session, std::span<const ChunkId> lacking);
  /// Cancels everything and joins the thread; refuses what comes later.
  void stop();

 private:
  void run(const std::shared_ptr<const Session>& session);

  const OnDone on_done_;
  const std::shared_ptr<spdlog::logger> log_;
  std::atomic<bool> cancel_ = false;
  std::mutex mutex_;
  std::map<const LiveRanks*, std::set<ChunkId>> waiting_;  // of the sessions that have a job
  JobQueue queue_;
};

}  // namespace curvecast::server
