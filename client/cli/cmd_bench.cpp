#include <absl/strings/str_cat.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "client/cli/commands.h"
#include "client/cli/sibling_program.h"

namespace curvecast::cli {
namespace {

/// Becomes curvecast-bench; returns only where that fails.
absl::Status run(std::vector<std::string> words) {
  const absl::StatusOr<std::string> program = sibling_program("curvecast-bench");
  if (!program.ok()) {
    return absl::NotFoundError(absl::StrCat(program.status().message(),
                                            "; benchmarks are a program of their own: deploy/build curvecast-bench makes it"));
  }
  words.insert(words.begin(), *program);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(program->c_str(), argv.data());
  return absl::FailedPreconditionError(absl::StrCat(*program, " cannot be run: ", std::strerror(errno)));
}

}  // namespace

Command add_bench(CLI::App& root, CommonOptions&) {
  CLI::App* app = root.add_subcommand("bench", "Runs a benchmark, of those that `curvecast bench --list` lists.");
  // Everything after the word is for the other program, --help too.
  app->prefix_command();
  app->set_help_flag();
  return {app, [app](const CommonOptions&, const std::stop_token&) { return run(app->remaining()); }};
}

}  // namespace curvecast::cli
