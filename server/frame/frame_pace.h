// Decides how many points keep up with the camera.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/convert/point_set_request.h"

namespace curvecast::server {

/// The number of points of one client's automatic budgets. Frames that change little cost little, however many points they have:
/// so the number grows until frames take too long. Not thread-safe.
class FramePace {
 public:
  using Seconds = std::chrono::duration<double>;

  /// Returns the number of points for the next view.
  std::uint64_t points(const AutomaticBudget& budget) const;
  /// Notes that a frame of `points` points took so long, from its start on the server to the client's acknowledgement.
  void observe(const AutomaticBudget& budget, std::uint64_t points, Seconds took);

 private:
  std::uint64_t points_ = 20'000;
};

}  // namespace curvecast::server
