// What a view costs from the client that sends it to the points that it holds: over TCP, alone and among many.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct StreamBenchOptions {
  std::uint64_t points = 50'000;        // of one client's views
  std::uint64_t crowd_points = 20'000;  // of each of many clients' views
  std::uint64_t clients = 64;           // the largest crowd
  double seconds = 10;                  // for each crowd
  double rate = 10;                     // views of each client per second
  bool abuse = true;                    // a crowd beside clients that behave badly
  std::uint64_t idle = 500;             // clients that have their points and do nothing; 0 = not measured
  std::string command = {};             // that is a server with "serve"; empty: this program
};

/// A server in a process of its own, on a free port of the loopback, and its clients in this one. Cases: one client that waits
/// for each frame, with key frames and with deltas on an orbit by one degree; then crowds of 1, 8, 64 ... clients that send views
/// at a fixed rate; at last clients that hold points and do nothing. Latency is from sending a view until its points are decoded.
/// Errors as of the client library.
absl::StatusOr<BenchReport> bench_stream(const MeshFile& file, const StreamBenchOptions& options,
                                         const ExecutionContext& context);

}  // namespace curvecast::cli::bench
