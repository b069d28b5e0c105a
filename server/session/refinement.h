// What refining a session's curve keeps from one refinement to the next, as long as anybody has the session.
#pragma once

#include <atomic>
#include <memory>

namespace curvecast::server {

struct RefinementSurface;

struct Refinement {
  /// No finer curve will be made: the limit was reached, refining failed, or the session was closed. Set by any thread.
  std::atomic<bool> is_over = false;
  /// Used by the refiner's thread only; null before the first refinement.
  std::shared_ptr<RefinementSurface> surface;
};

}  // namespace curvecast::server
