// How many points keep up with the camera.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/convert/sample.h"

namespace curvecast::server {

/// Of one client. Frames that change little cost little, whatever their number of points: so it grows until it costs too much.
class FramePace {
 public:
  using Seconds = std::chrono::duration<double>;

  /// For the next view.
  std::uint64_t points(const AutomaticBudget& budget) const;
  /// A frame of so many points took so long, from its start on the server to the client's acknowledgement.
  void observe(const AutomaticBudget& budget, std::uint64_t points, Seconds took);

 private:
  std::uint64_t points_ = 20'000;
};

}  // namespace curvecast::server
