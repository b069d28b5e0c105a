// Makes curves finer in the background, for views that found them too coarse.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "core/refine/refine.h"
#include "server/base/job_queue.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. One thread of low priority; of each session one refinement runs or waits at most.
class Refiner {
 public:
  /// Called, without locks, by the refiner's thread when a refinement is over, whether it changed the curve or not.
  using OnDone = std::function<void(const Session& session, bool is_finer)>;

  /// At most `max_vertices` curve vertices for each session; 0: never refines.
  Refiner(std::uint64_t max_vertices, OnDone on_done, std::shared_ptr<spdlog::logger> log);
  ~Refiner();  // stop()

  /// Somebody found `curve`, a revision of the session's, too coarse. `source` tells those who ask apart: of each only the newest
  /// demand counts, and what waits for its turn is met together. Returns whether a finer revision is being made or is there
  /// already, so that on_done is called, or was called, after `curve` was taken: false once the session's limit is reached, or
  /// forget() or stop() was called.
  bool request(const std::shared_ptr<const Session>& session, const SurfaceCurve& curve, std::uint64_t source,
               CurveDemand demand);
  /// The session was closed: what runs for it is cancelled, and later requests are refused.
  void forget(const Session& session);
  /// Cancels everything and joins the thread; refuses what comes later.
  void stop();

 private:
  void run(const std::shared_ptr<Refinement>& task);
  absl::StatusOr<RefinedCurve> refine_once(Refinement& task, const Session& session,
                                           const std::vector<CurveDemand>& demands) const;
  std::uint64_t affordable_vertices(const SurfaceCurve& curve) const;

  const std::uint64_t max_vertices_;
  const OnDone on_done_;
  const std::shared_ptr<spdlog::logger> log_;
  std::mutex mutex_;
  std::shared_ptr<Refinement> running_;
  bool stopped_ = false;
  JobQueue queue_;
};

}  // namespace curvecast::server
