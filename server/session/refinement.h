// What refining a session's curve keeps from one refinement to the next, as long as anybody has the session.
#pragma once

#include <atomic>

namespace curvecast::server {

struct Refinement {
  /// No finer curve will be made: the limit was reached, refining failed, or the session was closed. Set by any thread.
  std::atomic<bool> is_over = false;
};

}  // namespace curvecast::server
