// What all commands share: options, the server they talk to, output.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "client/lib/client.h"

namespace CLI {  // its header has globals that every source would compile anew
class App;
class Option;
class Validator;
}  // namespace CLI

namespace curvecast::server {
class Server;
}

namespace curvecast::cli {

using Json = nlohmann::ordered_json;

/// Help for a mesh argument.
inline constexpr char kMeshHelp[] =
    "a .ply, .obj, .off, .stl, .gltf, .glb or .3mf file; what it refers to is taken from its folder";

struct CommonOptions {
  std::string server;      // "host:port"; empty = a server within this process
  client::TlsFiles tls;    // what this side shows and believes; all empty: no encryption
  std::string token_file;  // of what the server knows this client by; empty: $CURVECAST_TOKEN, or nothing
  std::uint64_t seed = 0;
  int threads = 0;           // of the server within this process; 0 = one per core
  std::uint64_t memory = 0;  // bytes, of this process; 0 = 70 % of what there is
  std::string cache;         // folder of the server within this process; empty = the user's own, see add_cache_flags
  bool no_cache = false;
  bool json = false, quiet = false, verbose = false;
};

/// One subcommand. `run` is called when it was chosen.
struct Command {
  CLI::App* app = nullptr;
  std::function<absl::Status(const CommonOptions& options, std::stop_token stop)> run;
};

/// Adds a subcommand with the common options; `examples` are lines of its help.
CLI::App* add_command(CLI::App& root, CommonOptions& options, const std::string& name, const std::string& description,
                      const std::vector<std::string>& examples);

/// Adds an option for a number of bytes: 10GB, 500MB, powers of 1024.
CLI::Option* add_bytes(CLI::App& command, const std::string& name, std::uint64_t& bytes, const std::string& help);

/// Adds --cache and --no-cache, for commands that make sessions (Host with SessionCaching::kKeep).
void add_cache_flags(CLI::App* command, CommonOptions& options);

/// Makes CLI11 refuse a value with the message of `check`'s status.
CLI::Validator validator(std::function<absl::Status(const std::string& value)> check, const std::string& type_name);

/// 1 to kMaxPoints.
CLI::Validator point_count_range();

/// OK when the ending of `path` is one of `endings` (lower case, with the dot).
absl::Status check_ending(const std::string& path, const std::vector<std::string>& endings);

/// Makes a folder where there is none, and those above it. FailedPrecondition names it.
absl::Status make_folder(const std::string& folder);

/// Whether a server within this process keeps its sessions in a folder, for commands to come.
enum class SessionCaching {
  kNone,
  kKeep,     // in the one given, or $XDG_CACHE_HOME/curvecast, or ~/.cache/curvecast
  kKeepAll,  // in the one given, and none makes room for others
};

/// A client of --server or, without it, of a server that lives and ends with this object: one code path for both.
class Host {
 public:
  /// Where the user's own cache cannot be used, it goes without and says so; a folder that was asked for is an error.
  static absl::StatusOr<std::unique_ptr<Host>> open(const CommonOptions& options, SessionCaching caching = SessionCaching::kNone);
  ~Host();
  client::Client& client() { return client_; }

 private:
  Host(std::unique_ptr<server::Server> server, std::shared_ptr<client::Connection> connection);

  std::unique_ptr<server::Server> server_;  // null when remote
  client::Client client_;
};

struct OpenedMesh {
  client::UploadedMesh mesh;
  v1::Session session;  // ready
  double seconds = 0;   // that it took, upload included
};

/// Uploads a mesh with what it refers to, and waits for its session.
absl::StatusOr<OpenedMesh> open_mesh(client::Client& client, const std::string& path, const v1::SessionOptions& session_options,
                                     const client::StageProgress& on_progress, std::stop_token stop);
/// The same, and shows progress unless `quiet`.
absl::StatusOr<OpenedMesh> open_mesh(client::Client& client, const std::string& path, const v1::SessionOptions& session_options,
                                     bool quiet, std::stop_token stop);

/// N that a session is made for, when N points are wanted: at least the API's default, so that most commands share one session.
std::uint64_t session_points(std::uint64_t points);

/// The one JSON object of standard output. FailedPrecondition when it cannot be written.
absl::Status print_json(const Json& json);
/// Text for standard output, if there is no --json.
absl::Status print_text(const std::string& text);

}  // namespace curvecast::cli
