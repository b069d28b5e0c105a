// What the programs have in common: parsing, signals, exit statuses.
#pragma once

#include <functional>
#include <vector>

#include "client/cli/common.h"

namespace curvecast::cli {

/// Adds the commands of a program, each of which fills the common options.
using AddCommands = std::function<std::vector<Command>(CLI::App& root, CommonOptions& options)>;

/// Parses the arguments, runs the command that they name and ends the process with its exit status (see ExitStatus), or, where
/// sanitisers have to see the end of main(), returns it. Prints help, and errors to standard error. Call it before any other
/// thread exists: it blocks signals, see SignalWatcher.
int run_program(int argc, const char* const* argv, const AddCommands& add_commands);

}  // namespace curvecast::cli
