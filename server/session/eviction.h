// Chooses which sessions leave the memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace curvecast::server {

/// What all sessions in memory may take together.
struct SessionLimits {
  std::size_t sessions = 64;
  std::uint64_t bytes = std::uint64_t{8} << 30;
  std::size_t in_making_of_one = std::numeric_limits<std::size_t>::max();  // of one caller
};

/// A session in memory.
struct Resident {
  std::string id;
  std::uint64_t last_used = 0;  // greater: later
  std::uint64_t bytes = 0;
  bool may_go = false;      // it is neither in use nor pinned nor being made
  bool is_unsaved = false;  // it would be lost
};

struct Eviction {
  std::vector<std::string> ids;  // in the order in which they go
  bool is_enough = true;         // the rest is within the limits
  std::size_t sessions = 0;      // that stay
  std::uint64_t bytes = 0;       // of them
};

/// Chooses the least recently used of the sessions that may go, no more than it takes to bring the rest within the limits. Those
/// that are not saved yet come after all others.
Eviction choose_evicted(std::vector<Resident> residents, const SessionLimits& limits);

}  // namespace curvecast::server
