#include <absl/strings/str_cat.h>

#include <condition_variable>
#include <memory>
#include <mutex>

#include "client/cli/commands.h"
#include "client/cli/session_flags.h"

namespace curvecast::cli {
namespace {

constexpr std::chrono::seconds kDrain{5};  // that running calls get to end

struct Flags {
  std::string listen = "127.0.0.1:50051";
  std::vector<std::string> meshes;
  SessionFlags session;
  std::string cache;
  std::uint64_t cache_bytes = server::ServerOptions().cache_bytes;
};

/// `listen` with the port that was really taken.
std::string address_of(const std::string& listen, int port) {
  return absl::StrCat(listen.substr(0, listen.rfind(':')), ":", port);
}

void wait_for(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait(lock, stop, [] { return false; });
}

/// With --json, the lines go to standard error and the object follows when all meshes are open.
absl::Status announce(const CommonOptions& options, const std::string& line) {
  if (!options.json) return print_text(line + "\n");
  if (!options.quiet) std::fprintf(stderr, "%s\n", line.c_str());
  return absl::OkStatus();
}

absl::Status open_meshes(const Flags& flags, const CommonOptions& options, server::Server& server, const std::string& address,
                         const std::stop_token& stop) {
  client::Client client(client::make_connection(server.in_process_channel()));
  const absl::StatusOr<v1::SessionOptions> session_options = make_session_options(flags.session, session_points(0));
  if (!session_options.ok()) return session_options.status();
  Json sessions = Json::array();
  for (const std::string& path : flags.meshes) {
    absl::StatusOr<OpenedMesh> opened = open_mesh(client, path, *session_options, options.quiet, stop);
    if (!opened.ok()) return opened.status();
    sessions.push_back({{"mesh", path}, {"session_id", opened->session.session_id()}});
    if (absl::Status status = announce(options, absl::StrCat("session ", opened->session.session_id(), " ", path));
        !status.ok()) {
      return status;
    }
  }
  return options.json ? print_json({{"address", address}, {"port", server.port()}, {"sessions", sessions}}) : absl::OkStatus();
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  if (!options.server.empty()) return absl::InvalidArgumentError("serve is a server itself: --server does not apply");
  server::ServerOptions server_options;
  server_options.listen = flags.listen;
  server_options.threads = options.threads;
  server_options.log = !options.quiet;
  server_options.cache = flags.cache;
  server_options.cache_bytes = flags.cache_bytes;
  absl::StatusOr<std::unique_ptr<server::Server>> server = server::Server::start(server_options);
  if (!server.ok()) return server.status();
  const std::string address = address_of(flags.listen, (*server)->port());
  absl::Status status = announce(options, "listening on " + address);
  if (status.ok()) status = open_meshes(flags, options, **server, address, stop);
  if (status.ok()) wait_for(stop);
  (*server)->shutdown(kDrain);
  // To be stopped is how a server ends well, even while it opens a mesh.
  return stop.stop_requested() ? absl::OkStatus() : status;
}

}  // namespace

Command add_serve(CLI::App& root, CommonOptions& options) {
  CLI::App* app =
      add_command(root, options, "serve",
                  "Keeps meshes prepared for any number of clients (gRPC, without encryption). Prints its address when it is "
                  "ready and a line per opened mesh. SIGTERM or Ctrl-C: running calls get 5 seconds to end; status 0.",
                  {"curvecast serve --open bunny.obj --open igea.ply",
                   "curvecast serve --listen 0.0.0.0:50051 --cache /var/cache/curvecast --cache-size 50GB"});
  const auto flags = std::make_shared<Flags>();
  app->add_option("--listen", flags->listen, "host:port; port 0 takes any free one")->type_name("ADDRESS")->capture_default_str();
  app->add_option("--cache", flags->cache,
                  "folder where sessions survive a restart; made if missing; several servers may share one; without it, none")
      ->type_name("DIR");
  app->add_option("--cache-size", flags->cache_bytes,
                  "bytes that it may take (10GB, 500MB; powers of 1024); the least recently used sessions go first")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("BYTES")
      ->capture_default_str();
  app->add_option("--open", flags->meshes,
                  "a mesh (.ply, .obj, .off, .stl, .gltf, .glb) to prepare at once, for 65,536 points; repeat for more")
      ->type_name("MESH")
      ->allow_extra_args(false);
  add_session_flags(app, &flags->session);
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
