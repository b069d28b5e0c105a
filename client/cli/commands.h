// The subcommands; each is in a file of its own.
#pragma once

#include "client/cli/common.h"

namespace curvecast::cli {

/// Where `serve` listens, and whom `health` asks, if they are told nothing.
inline constexpr char kDefaultAddress[] = "127.0.0.1:50051";

Command add_serve(CLI::App& root, CommonOptions& options);
Command add_info(CLI::App& root, CommonOptions& options);
Command add_preprocess(CLI::App& root, CommonOptions& options);
Command add_sample(CLI::App& root, CommonOptions& options);
Command add_tiles(CLI::App& root, CommonOptions& options);
Command add_batch(CLI::App& root, CommonOptions& options);
Command add_stream(CLI::App& root, CommonOptions& options);
Command add_measure(CLI::App& root, CommonOptions& options);
Command add_remesh(CLI::App& root, CommonOptions& options);
Command add_render(CLI::App& root, CommonOptions& options);
Command add_sessions(CLI::App& root, CommonOptions& options);
Command add_health(CLI::App& root, CommonOptions& options);
Command add_bench(CLI::App& root, CommonOptions& options);

}  // namespace curvecast::cli
