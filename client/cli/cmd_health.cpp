#include <absl/strings/str_cat.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cmath>
#include <memory>

#include "client/cli/commands.h"

namespace curvecast::cli {
namespace {

constexpr double kMaxDeadline = 3600;  // seconds

struct Flags {
  double deadline = 3;  // seconds
};

absl::Status run(const Flags& flags, const CommonOptions& options, const std::stop_token& stop) {
  const absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  const std::chrono::milliseconds timeout(std::lround(1000 * flags.deadline));
  const absl::StatusOr<client::Health> health = (*host)->client().check_health(timeout, stop);
  if (absl::IsDeadlineExceeded(health.status())) {
    return absl::DeadlineExceededError(absl::StrCat("no answer within ", flags.deadline, " s"));
  }
  if (!health.ok()) return health.status();
  if (*health != client::Health::kServing) {
    return absl::AbortedError("NOT_SERVING: its meshes are being prepared, or it is about to end");
  }
  if (options.json) return print_json({{"server", options.server}, {"status", "SERVING"}});
  return print_text("SERVING\n");
}

}  // namespace

Command add_health(CLI::App& root, CommonOptions& options) {
  CLI::App* app =
      add_command(root, options, "health",
                  "Asks a server whether it serves, through gRPC's health service (grpc.health.v1), which needs no "
                  "token: for probes, where there is no shell. Prints SERVING; else says why not, and the status is 4.",
                  {"curvecast health", "curvecast health localhost:50051 --deadline 1",
                   "curvecast health replica-0.example.org:50051 --tls-ca ca.pem --json"});
  const auto flags = std::make_shared<Flags>();
  app->remove_option(app->get_option("--server"));
  app->add_option("ADDRESS,--server", options.server, absl::StrCat("host:port of the server; default: ", kDefaultAddress));
  app->add_option("--deadline", flags->deadline, "for the answer; none within it is as bad as a bad one")
      ->check(CLI::Range(0.001, kMaxDeadline))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->parse_complete_callback([&options] {
    if (options.server.empty()) options.server = kDefaultAddress;
  });
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
