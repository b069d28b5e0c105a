// Makes curves finer in the background, for views that found them too coarse.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "core/refine/refine.h"
#include "server/session/improvement_jobs.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Makes the next revision of a session's curve, fine enough for all of the demands as far as `max_vertices` go, and publishes
/// it; none where no leaf can be divided. Errors as of refine(), Session::curve_base() and Session::status().
absl::StatusOr<RefinedCurve> refine_session(const Session& session, std::span<const CurveDemand> demands,
                                            std::uint64_t max_vertices, const ExecutionContext& context);

/// Thread-safe. One thread of low priority refines one session after the other.
class Refiner {
 public:
  /// Called without locks by the refiner's thread when a refinement is over, whether it changed the curve or not.
  using OnDone = std::function<void(const Session& session, bool is_finer)>;

  /// How many bytes of memory there are for curves at this moment.
  using Room = std::function<std::uint64_t()>;

  /// Makes at most `max_vertices` curve vertices for each session, and no more than take half of the room; 0: never refines.
  Refiner(std::uint64_t max_vertices, OnDone on_done, Room room, std::shared_ptr<spdlog::logger> log);

  /// Asks for a finer revision than `curve`, one of the session's. `source` tells clients apart: of each only the newest demand
  /// counts, and the demands of a session that waits for its turn are met together. Returns whether a finer revision is being
  /// made or is there already, so that on_done is called, or was called, after `curve` was taken: false once the session's limit
  /// is reached, or after forget() or stop().
  bool request(const std::shared_ptr<const Session>& session, const SurfaceCurve& curve, std::uint64_t source,
               CurveDemand demand);
  /// Cancels the refinement of a session that was closed, and refuses later requests for it.
  void forget(const Session& session);
  /// Cancels everything and joins the thread; refuses what comes later.
  void stop() { jobs_.stop(); }

 private:
  Improvement improve(const Session& session, const Demands<CurveDemand>& demands, const std::atomic<bool>& cancel) const;
  absl::StatusOr<RefinedCurve> refine_once(const Session& session, const Demands<CurveDemand>& demands,
                                           const std::atomic<bool>& cancel) const;
  std::uint64_t affordable_vertices(const SurfaceCurve& curve) const;

  const std::uint64_t max_vertices_;
  const Room room_;
  const std::shared_ptr<spdlog::logger> log_;
  ImprovementJobs<CurveDemand> jobs_;  // last: they use the others
};

}  // namespace curvecast::server
