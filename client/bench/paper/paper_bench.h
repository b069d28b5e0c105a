// Every table and figure of the paper, ours beside the paper's numbers: for whoever doubts.
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <stop_token>
#include <string>

#include "client/bench/paper/paper_report.h"
#include "client/cli/common.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

struct PaperBenchOptions {
  bool quick = false;   // far fewer points, small pictures
  std::string machine;  // on which it runs
};

struct PaperInput {
  std::string path;
  MeshFile file;  // the same
};

/// Measures every mesh in both ways (tables 1 and 2, figure 5), and draws the other figures with a server in this process. One
/// mesh, the squirrel if there is one, else the first, has the figures that show a single mesh. Errors as of preprocess() and
/// client::Client; Cancelled.
absl::StatusOr<PaperFindings> bench_paper(std::span<const PaperInput> inputs, const PaperBenchOptions& options,
                                          const CommonOptions& common, const ExecutionContext& context,
                                          const std::stop_token& stop);

}  // namespace curvecast::cli::bench
