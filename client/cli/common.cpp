#include "client/cli/common.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "client/cli/progress_bar.h"
#include "client/lib/file_bytes.h"
#include "client/lib/protocol.h"
#include "server/server.h"

namespace curvecast::cli {
namespace {

constexpr std::uint64_t kDefaultSessionPoints = 65'536;
constexpr int kMaxThreads = 1024;

/// Empty when the environment names none.
std::string default_cache() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && cache[0] == '/') return absl::StrCat(cache, "/curvecast");  // relative ones count as not set, says XDG
  const char* const home = std::getenv("HOME");
  return home != nullptr && home[0] == '/' ? absl::StrCat(home, "/.cache/curvecast") : "";
}

/// What the file holds, or the environment.
absl::StatusOr<std::string> read_token(const std::string& file) {
  constexpr std::uint64_t kMostBytes = 4096;
  const char* const token = std::getenv("CURVECAST_TOKEN");
  absl::StatusOr<std::string> bytes = token != nullptr ? token : "";
  if (!file.empty()) bytes = client::read_bytes(file, kMostBytes);
  if (!bytes.ok()) return bytes.status();
  const std::string text(absl::StripAsciiWhitespace(*bytes));
  const bool is_printable = std::ranges::all_of(text, [](char c) { return c > ' ' && c <= '~'; });
  if (!is_printable || (text.empty() && !file.empty())) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.empty() ? "$CURVECAST_TOKEN" : file, " holds no token: printable characters without blanks"));
  }
  return text;
}

}  // namespace

CLI::App* add_command(CLI::App& root, CommonOptions& options, const std::string& name, const std::string& description,
                      const std::vector<std::string>& examples) {
  CLI::App* command = root.add_subcommand(name, description);
  const std::string group = "Common";
  command->add_option("--server", options.server, "host:port of a running server; without it, the work is done in this process")
      ->group(group);
  const auto file = [&](const char* flag, std::string* path, const char* help) {
    command->add_option(flag, *path, help)->type_name("FILE")->group(group);
  };
  file("--tls-ca", &options.tls.ca, "certificates (PEM) of those whose servers are believed: turns on TLS");
  file("--tls-cert", &options.tls.cert, "the certificate (PEM) that this side shows, with those that vouch for it");
  file("--tls-key", &options.tls.key, "its private key (PEM, without a password)");
  file("--token-file", &options.token_file, "holds the token that a --server knows its client by; else $CURVECAST_TOKEN, if set");
  command->add_option("--seed", options.seed, "of all random numbers; the same seed gives the same bytes")
      ->capture_default_str()
      ->group(group);
  command->add_option("--threads", options.threads, "of the work in this process; 0 = one per core; never changes the result")
      ->check(CLI::Range(0, kMaxThreads))
      ->capture_default_str()
      ->group(group);
  add_bytes(*command, "--memory", options.memory,
            "for this process to take at most (3GB): what is more lies in a file in the cache's folder, slower but never killed; "
            "0: 70 % of what the machine or its container has; never changes the result")
      ->group(group);
  command->add_flag("--json", options.json, "one JSON object on standard output instead of text")->group(group);
  CLI::Option* quiet = command->add_flag("--quiet", options.quiet, "no progress and no notes, only results and errors");
  quiet->group(group);
  command->add_flag("--verbose", options.verbose, "the log of the server in this process too")->excludes(quiet)->group(group);
  command->footer(absl::StrCat("Examples:\n  ", absl::StrJoin(examples, "\n  "),
                               "\n\nExit status: 0 done; 2 wrong usage; 3 bad input; 4 server or network; 130 interrupted."));
  return command;
}

CLI::Option* add_bytes(CLI::App& command, const std::string& name, std::uint64_t& bytes, const std::string& help) {
  return command.add_option(name, bytes, help)
      ->transform(CLI::AsSizeValue(false))
      ->transform(validator(  // goes first; CLI11 takes -1 for a very large number
          [](const std::string& text) {
            return text.starts_with('-') ? absl::InvalidArgumentError("bytes are not negative") : absl::OkStatus();
          },
          ""))
      ->type_name("BYTES")
      ->capture_default_str();
}

void add_cache_flags(CLI::App* command, CommonOptions& options) {
  const std::string group = "Common";
  CLI::Option* cache = command->add_option("--cache", options.cache,
                                           "folder where prepared meshes are kept for later commands; default: "
                                           "$XDG_CACHE_HOME/curvecast or ~/.cache/curvecast");
  cache->type_name("DIR")->excludes(command->get_option("--server"))->group(group);
  command->add_flag("--no-cache", options.no_cache, "neither use nor fill that folder")->excludes(cache)->group(group);
}

CLI::Validator validator(std::function<absl::Status(const std::string& value)> check, const std::string& type_name) {
  return CLI::Validator(
      [check = std::move(check)](std::string& value) {
        const absl::Status status = check(value);
        return status.ok() ? std::string() : std::string(status.message());
      },
      type_name);
}

CLI::Validator point_count_range() { return CLI::Range(std::uint64_t{1}, client::kMaxPoints); }

absl::Status check_ending(const std::string& path, const std::vector<std::string>& endings) {
  const std::string ending = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (std::find(endings.begin(), endings.end(), ending) != endings.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("'", path, "' must end in ", absl::StrJoin(endings, ", ")));
}

absl::Status make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(folder, ": the folder cannot be made: ", error.message()));
}

Host::Host(std::unique_ptr<server::Server> server, std::shared_ptr<client::Connection> connection)
    : server_(std::move(server)), client_(std::move(connection)) {}

Host::~Host() = default;

absl::StatusOr<std::unique_ptr<Host>> Host::open(const CommonOptions& options, SessionCaching caching) {
  if (!options.server.empty()) {
    absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = client::tcp_channel(options.server);
    if (!options.tls.is_empty()) channel = client::tls_channel(options.server, options.tls);
    if (!channel.ok()) return channel.status();
    const absl::StatusOr<std::string> token = read_token(options.token_file);
    if (!token.ok()) return token.status();
    return std::unique_ptr<Host>(new Host(nullptr, client::make_connection(*std::move(channel), {.token = *token})));
  }
  if (!options.tls.is_empty()) return absl::InvalidArgumentError("--tls-ca, --tls-cert and --tls-key apply to a --server only");
  server::ServerOptions server_options;
  server_options.threads = options.threads;
  server_options.memory_bytes = options.memory;
  constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 62;
  server_options.max_upload_bytes = server_options.max_mesh_bytes = kNoLimit;  // they are the user's own
  server_options.log = options.verbose;
  if (caching == SessionCaching::kKeep && !options.no_cache) {
    server_options.cache = options.cache.empty() ? default_cache() : options.cache;
  } else if (caching == SessionCaching::kKeepAll) {
    server_options.cache = options.cache;
    server_options.cache_bytes = kNoLimit;
  }
  absl::StatusOr<std::unique_ptr<server::Server>> server = server::Server::start(server_options);
  if (absl::IsFailedPrecondition(server.status()) && options.cache.empty() && !server_options.cache.empty()) {
    if (!options.quiet) std::fprintf(stderr, "note: nothing is cached: %s\n", std::string(server.status().message()).c_str());
    server_options.cache.clear();
    server = server::Server::start(server_options);
  }
  if (!server.ok()) return server.status();
  std::shared_ptr<client::Connection> connection = client::make_connection((*server)->in_process_channel());
  return std::unique_ptr<Host>(new Host(*std::move(server), std::move(connection)));
}

absl::StatusOr<OpenedMesh> open_mesh(client::Client& client, const std::string& path, const v1::SessionOptions& session_options,
                                     const client::StageProgress& on_progress, std::stop_token stop) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<client::UploadedMesh> mesh = client.upload_with_companions(path, on_progress, stop);
  if (!mesh.ok()) return mesh.status();
  absl::StatusOr<v1::Session> session = client.create_session(*mesh, session_options, on_progress, stop);
  if (!session.ok()) return session.status();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return OpenedMesh{*std::move(mesh), *std::move(session), seconds};
}

absl::StatusOr<OpenedMesh> open_mesh(client::Client& client, const std::string& path, const v1::SessionOptions& session_options,
                                     bool quiet, std::stop_token stop) {
  ProgressBar bar(progress_style(quiet), std::filesystem::path(path).filename().string());
  const client::StageProgress on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
  return open_mesh(client, path, session_options, on_progress, std::move(stop));
}

std::uint64_t session_points(std::uint64_t points) { return std::max(points, kDefaultSessionPoints); }

absl::Status print_text(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return absl::FailedPreconditionError("standard output cannot be written");
  }
  return absl::OkStatus();
}

absl::Status print_json(const Json& json) {
  // Names of files need not be UTF-8.
  return print_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace curvecast::cli
