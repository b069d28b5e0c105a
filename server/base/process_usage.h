// What this process takes of the machine, for the metrics.
#pragma once

#include <cstdint>

namespace curvecast::server {

/// What the operating system says of this process; 0 where it does not say.
struct ProcessUsage {
  std::uint64_t resident_bytes = 0;
  double cpu_seconds = 0;        // of all threads, in user and system mode
  std::uint64_t open_files = 0;  // descriptors
  std::uint64_t threads = 0;
};

/// Asks the operating system.
ProcessUsage process_usage();

/// Bytes in memory of this process alone, without mapped files; 0 where nobody says.
std::uint64_t anonymous_bytes();

}  // namespace curvecast::server
