#include "client/cli/program.h"

#include <absl/strings/match.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "client/cli/exit_status.h"
#include "client/cli/signals.h"
#include "proto/tls/exit_cleanup.h"
#include "server/base/build_info.h"

namespace curvecast::cli {
namespace {

/// What else may be wrong where a server is there but no call gets through.
std::string encryption_hint(const absl::Status& status, const CommonOptions& options) {
  if (!absl::IsUnavailable(status) || absl::StrContains(status.message(), "refused")) return "";
  if (options.tls.is_empty()) return "; if the server is encrypted, name those who vouch for it: --tls-ca";
  return "; does --tls-ca vouch for the server's certificate, and does the server want one of yours: --tls-cert?";
}

int report_failure(const absl::Status& status, const CommonOptions& options, bool interrupted) {
  const ExitStatus exit = exit_status(status, interrupted);
  std::string message(status.message());
  if (exit == kInterrupted) message = "interrupted";
  if (exit == kServerError && !options.server.empty())
    message = "server " + options.server + ": " + message + encryption_hint(status, options);
  std::fprintf(stderr, "curvecast: %s\n", message.c_str());
  return exit;
}

int run(int argc, const char* const* argv, const AddCommands& add_commands) {
  CLI::App app("Low-discrepancy point sampling of meshes, streamed.", "curvecast");
  app.set_version_flag("--version", server::describe(server::build_info()));
  app.require_subcommand(1);
  app.footer("curvecast COMMAND --help tells all about a command.");
  CommonOptions options;
  const std::vector<Command> commands = add_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    // CLI11 only misses a command where there is an unknown one.
    const bool unknown = app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-';
    const std::string message = unknown ? std::string("there is no command '") + argv[1] + "'" : error.what();
    std::fprintf(stderr, "curvecast: %s\nRun curvecast --help or curvecast COMMAND --help for more.\n", message.c_str());
    return kWrongUsage;
  }
  const SignalWatcher signals;
  for (const Command& command : commands) {
    if (!command.app->parsed()) continue;
    const absl::Status status = command.run(options, signals.token());
    if (!status.ok()) return report_failure(status, options, signals.interrupted());
  }
  return kDone;
}

/// Ends the process without exit(), which destroys what libraries have for all of the process, while threads of gRPC that nobody
/// can wait for may still use it. All of ours is destroyed by now. Sanitisers look for leaks in exit().
void skip_exit([[maybe_unused]] int status) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  std::fflush(nullptr);
  std::_Exit(status);
#endif
}

}  // namespace

int run_program(int argc, const char* const* argv, const AddCommands& add_commands) {
  report_crashes();
  tls::skip_cleanup_at_exit();
  int status = kServerError;
  try {
    status = run(argc, argv, add_commands);
  } catch (const std::exception& error) {  // of the standard library, such as bad_alloc
    std::fprintf(stderr, "curvecast: %s\n", error.what());
  }
  skip_exit(status);
  return status;
}

}  // namespace curvecast::cli
