// The command `curvecast bench`.
#pragma once

#include "client/cli/common.h"

namespace curvecast::cli::bench {

/// Adds the command with a subcommand for each benchmark.
Command add_benchmarks(CLI::App& root, CommonOptions& options);

}  // namespace curvecast::cli::bench
