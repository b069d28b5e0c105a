// What it costs to go from the whole mesh down to its surface and back, and what is seen on the way.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <vector>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct ZoomBenchOptions {
  std::vector<std::uint64_t> points = {20'000, 50'000};  // of the views; a path for each, each on a server of its own
  int frames = 360;                                      // views of a path, down and up together
  int stops = 12;                                        // on the way down, and on the way up
  double rate = 30;                                      // views per second
  double nearest = 1.0 / 2000;                           // distance from the surface, in diagonals of the mesh's box
  int width = 1280, height = 960;                        // pixels of the views, and of each half of a picture
  int wander = 0;                                        // views of random places from near by, after the path
  std::string pictures = {};                             // a folder for a picture of each stop; empty: none, and no coverage
  std::string command = {};                              // that is a server with "serve"; empty: this program
};

/// A server in a process of its own, on a free port of the loopback, and one client that goes down to a place of the surface and
/// back up, by equal factors of distance, and waits at stops until nothing better follows. Views are even on the picture and hold
/// nothing else; the sampler is the progressive one. Tables tell of each stop; results of what happens in motion. Errors as of
/// the client library, read_mesh() and repair(), and of files.
absl::StatusOr<BenchReport> bench_zoom(const MeshFile& file, const ZoomBenchOptions& options, const ExecutionContext& context);

}  // namespace curvecast::cli::bench
