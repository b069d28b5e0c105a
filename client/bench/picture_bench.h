// Which picture the same bytes give: of points that are streamed, or of what users would send instead.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <vector>

#include "client/bench/bench_report.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct PictureBenchOptions {
  std::vector<std::uint64_t> points = {5'000, 20'000, 50'000};  // of the views: a path for each
  std::vector<double> distances = {1.25, 0.4, 0.1, 0.02};       // of the stops from the surface, in diagonals of the mesh's box
  int steps = 8;                                                // views from one stop to the next
  std::vector<std::string> density = {"picture"};               // terms, as --density has them: those of the viewer
  int size = 1000;                                              // pixels, of both sides of the picture
  std::string pictures = {};                                    // a folder for pictures of each stop, and charts; empty: none
  std::string command = {};                                     // that is a server with "serve"; empty: this program
};

/// A server in a process of its own, and one client that comes from where all of the mesh is seen down to its surface, and stops
/// on the way. At each stop: the picture of its points against one of the mesh itself, beside those of what as many bytes bring
/// otherwise: the mesh simplified and compressed by Draco, sent once; and points spread evenly, whatever is seen, sent once.
/// Errors as of the client library, load_mesh(), the renderers, and of files.
absl::StatusOr<BenchReport> bench_picture(const MeshFile& file, const PictureBenchOptions& options,
                                          const ExecutionContext& context);

}  // namespace curvecast::cli::bench
