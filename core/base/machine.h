// What this process has of its machine: a container may have less than all of it.
#pragma once

#include <cstdint>
#include <string>

namespace curvecast {

/// Returns the memory that this machine has, or its container's share where that is less, in bytes.
std::uint64_t machine_memory_bytes();

/// Returns the processors that this process may use, or as many as its container's share of their time comes to where that is
/// less, rounded up: 1 or more.
int machine_cores();

/// What control groups, of version 1 or 2, leave to a process.
struct GroupLimits {
  std::uint64_t memory_bytes = 0;
  double cores = 0;
};
/// Reads the least that the groups of this process and those around them may have; the largest numbers where nothing is limited.
/// Below `root` are proc/self/cgroup and sys/fs/cgroup: "/", but for tests.
GroupLimits read_group_limits(const std::string& root = "/");

}  // namespace curvecast
