#include <absl/strings/str_cat.h>
#include <CLI/CLI.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "client/cli/choice.h"
#include "client/cli/commands.h"
#include "client/cli/configuration.h"
#include "client/cli/exit_status.h"
#include "client/cli/session_flags.h"
#include "client/cli/signals.h"
#include "client/web/viewer_files.h"
#include "server/net/loopback.h"
#include "server/server.h"

namespace curvecast::cli {
namespace {

constexpr double kMaxDrain = 3600;                       // seconds
constexpr std::uint32_t kMaxStreamAge = 30 * 24 * 3600;  // seconds
constexpr std::uint64_t kMaxSessions = 100'000;
constexpr std::size_t kMostAtOnce = 1'000'000;
constexpr std::uint64_t kMaxCurveVertices = 1'000'000'000;
constexpr std::array<std::string_view, 2> kLogFormats = {"text", "json"};

constexpr char kHttp[] = "127.0.0.1:8080";
constexpr char kNone[] = "none";
constexpr std::uint64_t kWarmPoints = 32'768;  // as many as a view is first answered with

struct Flags {
  server::ServerOptions server = {.listen = kDefaultAddress, .http = kHttp};
  std::vector<std::string> meshes;
  SessionFlags session;
  std::uint64_t points = 65'536;     // for which the sessions of `meshes` are made
  std::uint32_t crash_pause = 60;    // seconds
  std::uint32_t max_stream_age = 0;  // seconds
  double drain = 5;                  // seconds
  double lame_duck = 0;              // seconds
  double max_stop_time = 30;         // seconds
  std::string log_format = "text";
  std::string config;  // path; empty: none
  bool print_config = false;
  bool open_to_all = false;
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

/// With --json, the lines go to standard error and the object follows when all meshes are open. A server that nobody listens to
/// serves on.
void announce(const CommonOptions& options, const std::string& line) {
  if (!options.json) {
    print_text(line + "\n").IgnoreError();
  } else if (!options.quiet) {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
}

/// With --json, prints `object` with the sessions in it, which are added to `ids`. `viewer`: its address; empty: there is none.
absl::Status open_meshes(const Flags& flags, const CommonOptions& options, client::Client& client, const std::string& viewer,
                         Json object, std::vector<std::string>& ids, const std::stop_token& stop) {
  const absl::StatusOr<v1::SessionOptions> session_options = make_session_options(flags.session, flags.points);
  if (!session_options.ok()) return session_options.status();
  Json sessions = Json::array();
  for (const std::string& path : flags.meshes) {
    absl::StatusOr<OpenedMesh> opened = open_mesh(client, path, *session_options, options.quiet, stop);
    if (!opened.ok()) return opened.status();
    sessions.push_back({{"mesh", path}, {"session_id", opened->session.session_id()}});
    const std::string& id = ids.emplace_back(opened->session.session_id());
    announce(options, absl::StrCat("session ", id, " ", path));
    if (!viewer.empty()) announce(options, absl::StrCat("look at ", viewer, "#session=", id));
  }
  object["sessions"] = std::move(sessions);
  if (options.json) print_json(object).IgnoreError();
  return absl::OkStatus();
}

/// Has the points made that the first views of these sessions will want, so that nobody has to wait for them.
void warm_up(client::Client& client, const std::vector<std::string>& ids, const std::stop_token& stop) {
  for (const std::string& id : ids) {
    v1::ResampleRequest request;
    request.set_session_id(id);
    request.mutable_sample()->set_points(kWarmPoints);
    request.mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
    if (!client.resample_encoded(request, stop).ok()) return;  // views will tell whoever asks for them
  }
}

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(std::lround(1000 * seconds)); }

/// The lines in the log that say how the server was set up.
std::vector<std::string> describe(const std::vector<Setting>& settings) {
  std::vector<std::string> lines;
  lines.reserve(settings.size());
  for (const Setting& setting : settings) {
    lines.push_back(absl::StrCat("setting ", setting.name, " = ", setting.value, " (", setting.source, ")"));
  }
  return lines;
}

absl::Status serve(const Flags& flags, const CommonOptions& options, const server::ServerOptions& server_options,
                   const std::stop_token& stop) {
  std::signal(SIGPIPE, SIG_IGN);  // where its lines go to may end before it
  const bool has_files = !server_options.tokens.empty() || !server_options.tls_cert.empty();
  if (has_files) {
    HangUpWatcher::hold_back();
  } else if (!has_terminal()) {
    std::signal(SIGHUP, SIG_IGN);  // a reload, with nothing to read
  }
  absl::StatusOr<std::unique_ptr<server::Server>> server = server::Server::start(server_options);
  if (!server.ok()) return server.status();
  std::optional<HangUpWatcher> hang_ups;
  if (has_files) hang_ups.emplace([&] { (*server)->reload().IgnoreError(); });  // the log tells
  Json addresses = {{"address", address_of(server_options.listen, (*server)->port())}, {"port", (*server)->port()}};
  announce(options, "listening on " + addresses["address"].get<std::string>());
  if (!server_options.admin.empty()) {
    addresses["admin"] = address_of(server_options.admin, (*server)->admin_port());
    announce(options, "admin on " + addresses["admin"].get<std::string>());
  }
  std::string viewer;
  if (!server_options.http.empty()) {
    const std::string http = address_of(server_options.http, (*server)->http_port());
    addresses["http"] = http;
    announce(options, "http on " + http);
    if (!server_options.pages.empty()) {
      viewer = absl::StrCat(server_options.tls_cert.empty() ? "http://" : "https://", http, "/");
      addresses["viewer"] = viewer;
      announce(options, "viewer on " + viewer);
    }
  }
  client::Client client(client::make_connection((*server)->in_process_channel()));
  std::vector<std::string> sessions;
  absl::Status status = open_meshes(flags, options, client, viewer, std::move(addresses), sessions, stop);
  if (status.ok()) {
    (*server)->set_ready();
    warm_up(client, sessions, stop);
    wait_for(stop);
    if (flags.lame_duck > 0) {
      (*server)->retire();
      std::this_thread::sleep_for(std::chrono::duration<double>(flags.lame_duck));  // a second signal ends the process
    }
  }
  const absl::Status ended = (*server)->shutdown_within(milliseconds(flags.drain), milliseconds(flags.max_stop_time));
  if (!ended.ok()) {
    std::fprintf(stderr, "curvecast: %s\n", std::string(ended.message()).c_str());
    std::_Exit(exit_status(ended, false));  // what holds the server up would hold up its destruction too
  }
  // To be stopped is how a server ends well, even while it opens a mesh.
  return stop.stop_requested() ? absl::OkStatus() : status;
}

/// Refuses to let everybody call who can connect from elsewhere, unless that is what is wanted.
absl::Status check_openness(const server::ServerOptions& options) {
  if (!options.tokens.empty() || !options.tls_client_ca.empty()) return absl::OkStatus();
  for (const std::string& address : {options.listen, options.http}) {
    if (address.empty() || server::is_loopback(address)) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        address, " can be reached from other machines, and whoever reaches it may call: ask for tokens (--tokens) or ",
        "certificates (--tls-client-ca), or say that this is meant (--open-to-all)"));
  }
  return absl::OkStatus();
}

/// `flags` and `options` are those that `app` fills.
absl::Status run(CLI::App& app, const Flags& flags, const CommonOptions& options, const std::stop_token& stop) {
  if (!options.server.empty()) return absl::InvalidArgumentError("serve is a server itself: --server does not apply");
  const absl::StatusOr<std::vector<Setting>> settings = configure(app, flags.config);
  if (!settings.ok()) return settings.status();
  if (options.quiet && options.verbose) return absl::InvalidArgumentError("quiet and verbose exclude each other");
  if (flags.print_config) return print_text(to_configuration(app));
  server::ServerOptions server_options = flags.server;
  server_options.threads = options.threads;
  server_options.memory_bytes = options.memory;
  server_options.crash_pause = std::chrono::seconds(flags.crash_pause);
  server_options.max_stream_age = std::chrono::seconds(flags.max_stream_age);
  server_options.log = !options.quiet;
  server_options.verbose = options.verbose;
  server_options.log_format = flags.log_format == "json" ? server::LogFormat::kJson : server::LogFormat::kText;
  server_options.notes = describe(*settings);
  server_options.ready = flags.meshes.empty();
  server_options.tls_cert = options.tls.cert;
  server_options.tls_key = options.tls.key;
  if (server_options.http == kNone) server_options.http.clear();
  if (server_options.admin.find_first_not_of("0123456789") == std::string::npos && !server_options.admin.empty()) {
    server_options.admin = "127.0.0.1:" + server_options.admin;
  }
  if (absl::Status status = check_openness(server_options); !flags.open_to_all && !status.ok()) return status;
  server_options.http_may_move = server_options.http == kHttp;  // nobody has asked for this very one
  server_options.pages = web::viewer_files();
  return serve(flags, options, server_options, stop);
}

void add_limit_flags(CLI::App* app, server::ServerOptions* server, std::uint32_t* max_stream_age) {
  const std::string group = "Limits";
  const auto bytes = [&](const char* name, std::uint64_t* value, const char* help) {
    add_bytes(*app, name, *value, help)->group(group);
  };
  bytes("--cache-size", &server->cache_bytes,
        "that sessions may take in the cache (10GB, 500MB; powers of 1024); the least recently used go first");
  bytes("--max-upload", &server->max_upload_bytes, "of one mesh file");
  bytes("--max-meshes", &server->max_mesh_bytes, "of all mesh files held; the least recently used go first");
  app->add_option("--max-sessions", server->max_sessions, "held in memory at once; the least recently used go first")
      ->check(CLI::Range(std::uint64_t{1}, kMaxSessions))
      ->capture_default_str()
      ->group(group);
  bytes("--max-session-memory", &server->max_session_bytes,
        "of all sessions, and no more than half of --memory; the least recently used go first, to the cache");
  bytes(
      "--max-queued", &server->max_queued_bytes,
      "of frames and point sets that wait to be read by their clients, and no more than an eighth of --memory; beyond half of it "
      "a client may have a sixteenth");
  const auto count = [&](const char* name, std::size_t* value, const char* help) {
    app->add_option(name, *value, help)->check(CLI::Range(std::size_t{1}, kMostAtOnce))->capture_default_str()->group(group);
  };
  count("--max-connections", &server->max_connections,
        "of the gRPC port, and no more than half of the files that the process may have open; for one more the oldest one gives "
        "way "
        "that has made no call");
  count("--max-streams", &server->max_streams, "of views, at once");
  count("--max-streams-of-client", &server->max_streams_of_client,
        "of one caller: a token, a certificate's name, or else an address");
  app->add_option(
         "--max-stream-age", *max_stream_age,
         "seconds after which a stream of views ends, a tenth more or less, so that its client connects anew, perhaps to another "
         "server; 0: never")
      ->check(CLI::Range(std::uint32_t{0}, kMaxStreamAge))
      ->capture_default_str()
      ->group(group);
  count("--max-making-of-client", &server->max_sessions_in_making_of_client,
        "sessions that are being made at once for one token, certificate or address");
  count("--max-uploads", &server->max_uploads, "at once");
  count("--max-uploads-of-client", &server->max_uploads_of_client, "of one caller");
  app->add_option("--max-view-rate", server->max_view_rate, "messages per second that are read from a stream")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str()
      ->group(group);
  app->add_option("--max-curve-vertices", server->max_curve_vertices,
                  "to which a session's curve is refined at most for views that want it finer; 0: never")
      ->check(CLI::Range(std::uint64_t{0}, kMaxCurveVertices))
      ->capture_default_str()
      ->group(group);
}

}  // namespace

Command add_serve(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "serve",
      "Keeps meshes prepared for any number of clients, and shows them in browsers (gRPC, and HTTP for the viewer; both "
      "encrypted with --tls-cert and --tls-key). Prints its addresses when it is "
      "ready and a line per opened mesh. SIGTERM or Ctrl-C: running calls get --drain seconds to end, and what goes to the "
      "cache gets --max-stop-time; status 0. A second one ends it at once; status 130. SIGHUP: reads the files of tokens and "
      "certificates anew, where there are any; else it ends a server whose terminal closes, and is nothing to one without a "
      "terminal.",
      {"curvecast serve --open bunny.obj --open igea.ply",
       "curvecast serve --listen 0.0.0.0:50051 --tokens /etc/curvecast.tokens --cache /var/cache/curvecast --cache-size 50GB",
       "curvecast serve --config /etc/curvecast.toml --http 0.0.0.0:8080 --open-to-all",
       "CURVECAST_LISTEN=0.0.0.0:50051 curvecast serve --print-config > curvecast.toml"});
  for (const char* name : {"--server", "--seed", "--json"}) app->get_option(name)->configurable(false);
  for (const char* name : {"--tls-ca", "--token-file"}) app->remove_option(app->get_option(name));
  const auto flags = std::make_shared<Flags>();
  app->add_option(
         "--config", flags->config,
         "settings from a file, a line NAME = VALUE for each option without its dashes; the environment goes before it "
         "(CURVECAST_LISTEN, CURVECAST_MAX_UPLOAD and so on; several values with semicolons between them), and flags before both")
      ->type_name("FILE")
      ->configurable(false);
  app->add_flag("--print-config", flags->print_config, "print all settings as such a file and end")->configurable(false);
  app->add_option("--listen", flags->server.listen, "host:port; port 0 takes any free one")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app->add_option(
         "--http", flags->server.http,
         "host:port of the viewer, for browsers, and of /healthz, /readyz (200 when all meshes are open, 503 before and "
         "while it ends) and /metrics (Prometheus); another port where the default one is in use; none: nothing of these")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app->add_option(
         "--admin", flags->server.admin,
         "host:port, or a port of 127.0.0.1, of /healthz, /readyz and /metrics, for all who reach it and never encrypted; "
         "/metrics is there only, then")
      ->type_name("ADDRESS");
  app->add_option("--web-origin", flags->server.web_origins,
                  "pages from elsewhere that may connect, or the viewer under a name with dots where callers need no token, by "
                  "the origin that "
                  "browsers send (https://example.org); repeat for more; *: all")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  app->add_option(
         "--cache", flags->server.cache,
         "folder where sessions and uploads survive a restart; made if missing; several servers may share one; without it, none")
      ->type_name("DIR");
  app->add_option("--store", flags->server.store,
                  "where servers share sessions and uploads, behind the --cache that each has for itself: file:///DIR, a folder "
                  "that all of them mount, or s3://BUCKET/PREFIX; an upload counts once it is there")
      ->type_name("URL");
  app->add_option("--open", flags->meshes,
                  "a mesh (.ply, .obj, .off, .stl, .gltf, .glb, .3mf) to prepare at once; repeat for more")
      ->type_name("MESH")
      ->allow_extra_args(false);
  app->add_option("-n,--points", flags->points, "of --open, N for which the curves are made fine enough, 1 to 4,000,000")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  app->add_option("--crash-pause", flags->crash_pause,
                  "seconds for which a session is refused whose making ended the server, with --cache; four times as long after "
                  "each further time, up to an hour")
      ->check(CLI::Range(0, 3600))
      ->capture_default_str();
  app->add_option("--drain", flags->drain, "that running calls get to end when the server is stopped")
      ->check(CLI::Range(0.0, kMaxDrain))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->add_option(
         "--lame-duck", flags->lame_duck,
         "that the server goes on when it is stopped, before --drain: health and /readyz say that it ends, so that balancers "
         "send their clients elsewhere")
      ->check(CLI::Range(0.0, kMaxDrain))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->add_option("--max-stop-time", flags->max_stop_time,
                  "that a stopped server takes beyond --drain, so that sessions get to the cache; then it names those in the log "
                  "that have not, and ends with status 4")
      ->check(CLI::Range(0.0, kMaxDrain))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->add_option("--log-format", flags->log_format, "of the log, on standard error: text, or json (an object per line)")
      ->check(validator([](const std::string& text) { return check_choice("log format", text, kLogFormats); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  app->add_option(
         "--tls-client-ca", flags->server.tls_client_ca,
         "certificates (PEM) of those who vouch for clients: without a certificate of theirs nobody may connect; the name "
         "in it is the client's, as that of a token's holder is")
      ->type_name("FILE");
  app->add_option("--tokens", flags->server.tokens,
                  "those who may call, everybody without it: lines of NAME, SHA-256 of the token, and maybe the second since "
                  "1970 in which it expires")
      ->type_name("FILE");
  app->add_option(
         "--trusted-proxy", flags->server.trusted_proxies,
         "network (10.0.0.0/8, fd00::/8) or address of proxies whose header x-forwarded-for, or of the PROXY protocol, names "
         "the client, for limits, shares and the log; repeat for more")
      ->type_name("CIDR")
      ->allow_extra_args(false);
  app->add_flag(
      "--open-to-all", flags->open_to_all,
      "let everybody call who can connect, from other machines too; without tokens or certificates of clients, addresses "
      "that are not of the loopback are refused else");
  app->add_flag("--isolate", flags->server.isolate,
                "give each holder of a token, or of a certificate's name, meshes and sessions of his own, which nobody else "
                "finds; those of "
                "--open are for all");
  app->add_option("--mesh-folder", flags->server.mesh_folder, "of which clients may import meshes; without it, none")
      ->type_name("DIR");
  add_limit_flags(app, &flags->server, &flags->max_stream_age);
  add_session_flags(app, &flags->session);
  return {app,
          [app, flags](const CommonOptions& common, const std::stop_token& stop) { return run(*app, *flags, common, stop); }};
}

}  // namespace curvecast::cli
