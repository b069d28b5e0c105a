#include "server/server.h"

#include <absl/strings/str_cat.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "core/base/spill.h"
#include "server/base/address.h"
#include "server/base/build_info.h"
#include "server/base/memory_share.h"
#include "server/base/protocol.h"
#include "server/base/scratch_folder.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/engine.h"
#include "server/grpc/grpc_port.h"
#include "server/grpc/service.h"
#include "server/net/descriptors.h"
#include "server/web/credentials.h"
#include "server/web/resources/resources.h"
#include "server/web/web_calls.h"
#include "server/web/web_gateway.h"
#include "server/web/web_poster.h"
#include "server/web/web_routes.h"

namespace curvecast::server {
namespace {

constexpr int kKeepaliveMs = 30'000;         // between pings to a silent client
constexpr int kKeepaliveTimeoutMs = 10'000;  // until it counts as gone
constexpr int kMinPingIntervalMs = 5'000;    // what a client may do
constexpr int kMaxCallsPerConnection = 256;
constexpr int kIdleMs = 5 * 60'000;   // a connection without calls is closed
constexpr int kHandshakeMs = 10'000;  // until a new connection has said what it wants
constexpr int kMaxRequestBytes = static_cast<int>(kMaxChunkBytes + kMaxChunkBytes / 4);  // an upload's chunk is the largest
constexpr std::size_t kAdminConnections = 16;           // for one more the one goes that has waited longest
constexpr std::chrono::milliseconds kLastFrames{2000};  // for those that are being made when the server ends
constexpr std::chrono::milliseconds kCloseTime{1000};   // for what is on its way over WebSockets when the server ends

/// That gRPC may take for what clients send, known or not.
std::size_t transport_bytes(const ServerOptions& options) {
  return std::max(std::size_t{64} << 20, static_cast<std::size_t>(memory_share(options) / 8));
}

/// Of channels to this process: results are as large as they are.
grpc::ChannelArguments within_process() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return arguments;
}

/// Sends a key with every call.
class KeySender final : public grpc::experimental::ClientInterceptorFactoryInterface {
 public:
  explicit KeySender(const std::string& key) : key_(key) {}

  grpc::experimental::Interceptor* CreateClientInterceptor(grpc::experimental::ClientRpcInfo* /*call*/) override {
    return new Sender(key_);
  }

 private:
  class Sender final : public grpc::experimental::Interceptor {
   public:
    explicit Sender(const std::string& key) : key_(key) {}
    void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
      using Point = grpc::experimental::InterceptionHookPoints;
      if (methods->QueryInterceptionHookPoint(Point::PRE_SEND_INITIAL_METADATA)) {
        methods->GetSendInitialMetadata()->emplace(kOwnKey, key_);
      }
      methods->Proceed();
    }

   private:
    const std::string key_;
  };

  const std::string key_;
};

class GrpcServer final : public Server {
 public:
  GrpcServer(const ServerOptions& options, std::shared_ptr<spdlog::logger> log, std::unique_ptr<SessionCache> cache,
             std::unique_ptr<MeshFolder> meshes, std::unique_ptr<WatchedStore> store, std::shared_ptr<const Tokens> tokens,
             TrustedProxies proxies, std::optional<ServerTls> tls)
      : options_(options),
        tls_(tls ? std::make_shared<Replaceable<ServerTls>>(std::make_shared<ServerTls>(*std::move(tls))) : nullptr),
        engine_(options, std::move(log), std::move(cache), std::move(tokens), std::move(proxies), std::move(meshes),
                std::move(store)),
        service_(engine_),
        unready_(options.ready ? "" : "meshes are being prepared") {
    if (options.ready && engine_.marks != nullptr) engine_.marks->enforce();
  }
  ~GrpcServer() override { shutdown(std::chrono::milliseconds(0)); }

  absl::Status listen(std::size_t descriptors) {
    grpc::EnableDefaultHealthCheckService(true);
    static std::once_flag reflection;  // the plugin is the whole process's and counts its own calls
    std::call_once(reflection, grpc::reflection::InitProtoReflectionServerBuilderPlugin);
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingIntervalMs);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxCallsPerConnection);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMs);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
    builder.SetMaxReceiveMessageSize(kMaxRequestBytes);
    builder.SetResourceQuota(grpc::ResourceQuota("curvecast").Resize(transport_bytes(options_)));
    if (!options_.listen.empty()) {
      auto port = GrpcPort::bind(options_.listen, *engine_.connections, share_descriptors(descriptors).reserve_from);
      if (!port.ok()) return port.status();
      port_ = *std::move(port);
      port_->add_to(builder, make_credentials(tls_));
    }
    grpc_ = builder.BuildAndStart();
    if (grpc_ == nullptr) return absl::UnavailableError("gRPC does not start");
    if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) {
      health->SetServingStatus(v1::CurvecastService::service_full_name(), true);
      health->SetServingStatus(options_.ready);
    }
    if (port_ != nullptr) port_->open([this](const std::string& peer) { return engine_.proxies.trusts(peer); });
    engine_.log->info("serving on {}", port_ == nullptr ? "this process" : absl::StrCat(options_.listen, ", port ", port()));
    return absl::OkStatus();
  }

  /// After listen(): whoever finds the HTTP port finds the other one too.
  absl::Status listen_http(std::size_t descriptors) {
    const DescriptorShares shares = share_descriptors(descriptors);
    WebGatewayOptions web{.listen = options_.http};
    if (tls_ != nullptr) web.tls = *tls_->get();
    web.max_connections = std::min(web.max_connections, shares.pages);
    const WebOrigins origins{.others = options_.web_origins, .any_name = engine_.knows_callers()};
    const WebResourceLimits limits{.most = std::max<std::size_t>(1, web.max_connections / 2),
                                   .most_of_client = std::max<std::size_t>(1, web.max_connections / 8)};
    web.sockets = {.path = "/v1/socket",
                   .identify = [this](const Peer& peer) { return identify(engine_, peer); },
                   .maker = web_calls(engine_, in_process_channel()),
                   .origins = origins,
                   .proxies = engine_.proxies,
                   .max_sockets = std::min(options_.max_streams, shares.sockets),
                   .max_sockets_of_client = options_.max_streams_of_client,
                   .late_routes = {{kPosterPath, posters(in_process_channel())}},
                   .resources = web_resources(engine_, in_process_channel(), origins, limits)};
    WebRoutes routes = page_routes(options_.pages);
    routes.merge(probe_routes(health()));
    if (options_.admin.empty()) routes.merge(metrics_routes(engine_));
    auto gateway = WebGateway::start(web, routes, engine_.log);
    if (absl::IsUnavailable(gateway.status()) && options_.http_may_move) {
      engine_.log->warn("{}; taking a free port", std::string(gateway.status().message()));
      web.listen = options_.http.substr(0, options_.http.rfind(':')) + ":0";
      gateway = WebGateway::start(web, routes, engine_.log);
    }
    if (!gateway.ok()) return gateway.status();
    web_ = *std::move(gateway);
    engine_.log->info("http on {}, port {}", web.listen, web_->port());
    return absl::OkStatus();
  }

  /// After listen().
  absl::Status listen_admin() {
    WebRoutes routes = probe_routes(health());
    routes.merge(metrics_routes(engine_));
    auto gateway = WebGateway::start({.listen = options_.admin, .max_connections = kAdminConnections}, routes, engine_.log);
    if (!gateway.ok()) return gateway.status();
    admin_ = *std::move(gateway);
    engine_.log->info("admin on {}, port {}", options_.admin, admin_->port());
    return absl::OkStatus();
  }

  int port() const override { return port_ == nullptr ? 0 : port_->port(); }
  int http_port() const override { return web_ == nullptr ? 0 : web_->port(); }

  int admin_port() const override { return admin_ == nullptr ? 0 : admin_->port(); }

  void set_ready() override {
    const MutexLock lock(mutex_);
    if (draining_) return;
    unready_.clear();
    if (engine_.marks != nullptr) engine_.marks->enforce();
    if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) health->SetServingStatus(true);
  }

  void retire() override {
    const MutexLock lock(mutex_);
    draining_ = true;
    unready_ = "the server is shutting down";
    if (engine_.marks != nullptr) engine_.marks->forgive();
    if (grpc_ == nullptr) return;
    if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) health->SetServingStatus(false);
  }

  std::shared_ptr<grpc::Channel> in_process_channel() override {
    std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> interceptors;
    interceptors.push_back(std::make_unique<KeySender>(engine_.own_key));
    return grpc_->experimental().InProcessChannelWithInterceptors(within_process(), std::move(interceptors));
  }

  absl::Status reload() override {
    const MutexLock lock(reload_mutex_);
    absl::Status status;
    const auto note = [&](const char* what, const absl::Status& read) {
      if (read.ok()) {
        engine_.log->info("{} read anew", what);
      } else {
        engine_.log->error("{} stay as they were: {}", what, std::string(read.message()));
      }
      status.Update(read);
    };
    if (!options_.tokens.empty()) note("tokens", reload_tokens());
    if (tls_ != nullptr) note("certificates", reload_tls());
    return status;
  }

  void shutdown(std::chrono::milliseconds drain) override {
    std::call_once(shutdown_, [&] {
      retire();
      if (grpc_ != nullptr) {
        engine_.log->info("shutting down: running calls get {} s", std::chrono::duration<double>(drain).count());
        if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) health->Shutdown();
        // A conversation has no end of its own to wait for.
        const absl::Status reason = absl::UnavailableError("the server is shutting down; reconnect");
        engine_.retire_streams(reason, std::min(drain, kLastFrames));
        engine_.stop_streams(reason);
        if (port_ != nullptr) port_->close();
        grpc_->Shutdown(std::chrono::system_clock::now() + drain);
        if (web_ != nullptr) web_->close_sockets(kCloseTime);
        engine_.log->info("stopped");
      }
      if (engine_.store != nullptr) engine_.store->end();  // jobs do not wait for it any more
      engine_.refiner.stop();
      engine_.rank_jobs.stop();
      engine_.views.stop();
      engine_.chunks.stop();
      engine_.calls.stop();
      engine_.preprocessing.stop();
      if (engine_.cache != nullptr) engine_.cache->stop();
      note_unstored();
    });
  }

  absl::Status shutdown_within(std::chrono::milliseconds drain, std::chrono::milliseconds patience) override {
    end_ = std::async(std::launch::async, [this, drain] { shutdown(drain); });
    if (end_.wait_for(drain + patience) == std::future_status::ready) return absl::OkStatus();
    const std::vector<std::string> unsaved = engine_.cache != nullptr ? engine_.cache->unsaved_ids() : std::vector<std::string>();
    for (const std::string& id : unsaved) engine_.log->error("session {} is not cached: there was no time left", id);
    note_unstored();
    return absl::DeadlineExceededError(
        absl::StrCat("the server could not end in time; sessions that are not in the cache: ", unsaved.size()));
  }

 private:
  /// Of sessions that are in the cache alone, until this server is started anew.
  void note_unstored() {
    if (engine_.cache == nullptr) return;
    for (const std::string& id : engine_.cache->unstored_ids()) {
      engine_.log->warn("session {} is not in the store: the next start with this cache puts it there", id);
    }
  }

  /// Why this server had better be started anew; empty where it need not.
  std::string dead() const { return port_ == nullptr || port_->answers() ? "" : "the gRPC port does not answer"; }

  /// Why nobody should send requests now; empty where all may.
  std::string unready() {
    const MutexLock lock(mutex_);
    return unready_.empty() ? dead() : unready_;
  }

  absl::Status reload_tokens() {
    absl::StatusOr<std::shared_ptr<const Tokens>> tokens = Tokens::read(options_.tokens);
    if (!tokens.ok()) return tokens.status();
    engine_.tokens.replace(*std::move(tokens));
    engine_.callers.end_refused();
    return absl::OkStatus();
  }

  absl::Status reload_tls() {
    absl::StatusOr<std::optional<ServerTls>> tls = read_server_tls(options_);
    if (!tls.ok()) return tls.status();
    if (web_ != nullptr) {
      if (absl::Status status = web_->replace_tls(**tls); !status.ok()) return status;
    }
    tls_->replace(std::make_shared<ServerTls>(**std::move(tls)));
    return absl::OkStatus();
  }

  WebHealth health() {
    return {.dead = [this] { return dead(); }, .unready = [this] { return unready(); }};
  }

  const ServerOptions options_;
  const std::shared_ptr<Replaceable<ServerTls>> tls_;  // null: not encrypted
  Mutex reload_mutex_;                                 // one at a time, so that the newest files stay
  Engine engine_;
  Service service_;
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<GrpcPort> port_;  // null: this process only
  Mutex mutex_;
  std::string unready_ ABSL_GUARDED_BY(mutex_);  // the reason; empty: ready
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  std::unique_ptr<WebGateway> web_, admin_;  // use all of the above
  std::once_flag shutdown_;
  std::future<void> end_;  // of a shutdown() on a thread of its own
};

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::start(const ServerOptions& options) {
  if (options.threads < 0) {
    return absl::InvalidArgumentError(absl::StrCat("threads is ", options.threads, "; 0 means one per core"));
  }
  if (options.isolate && options.tokens.empty() && options.tls_client_ca.empty()) {
    return absl::InvalidArgumentError(
        "isolate keeps callers apart by their names: it wants tokens, or certificates of clients, that give them some");
  }
  if (!options.store.empty() && options.cache.empty()) {
    return absl::InvalidArgumentError("a store wants a cache, from which sessions are used: give a folder for that, too");
  }
  for (const std::string* address : {&options.listen, &options.http, &options.admin}) {
    if (address->empty()) continue;
    if (const auto parsed = parse_address(*address); !parsed.ok()) return parsed.status();
  }
  absl::StatusOr<std::optional<ServerTls>> tls = read_server_tls(options);
  if (!tls.ok()) return tls.status();
  std::shared_ptr<const Tokens> tokens;
  if (!options.tokens.empty()) {
    absl::StatusOr<std::shared_ptr<const Tokens>> read = Tokens::read(options.tokens);
    if (!read.ok()) return read.status();
    tokens = *std::move(read);
  }
  absl::StatusOr<TrustedProxies> proxies = TrustedProxies::parse(options.trusted_proxies);
  if (!proxies.ok()) return proxies.status();
  return status_from_exceptions([&]() -> absl::StatusOr<std::unique_ptr<Server>> {
    std::shared_ptr<spdlog::logger> log = make_logger(options.log, options.verbose, options.log_format);
    log->info("{}", describe(build_info()));
    for (const std::string& note : options.notes) log->info("{}", note);
    if (tokens != nullptr && options.tls_cert.empty())
      log->warn("tokens come in clear text: without TLS whoever listens has them");
    std::unique_ptr<WatchedStore> store;
    if (!options.store.empty()) {
      absl::StatusOr<std::unique_ptr<Store>> opened = open_store(options.store);
      if (!opened.ok()) return opened.status();
      store = std::make_unique<WatchedStore>(options.store, *std::move(opened), log);
    }
    std::unique_ptr<SessionCache> cache;
    std::unique_ptr<MeshFolder> meshes;
    if (!options.cache.empty()) {
      auto opened = SessionCache::open(options.cache, options.cache_bytes, log, store.get());
      if (!opened.ok()) return opened.status();
      cache = *std::move(opened);
      absl::StatusOr<std::unique_ptr<MeshFolder>> folder = MeshFolder::open(cache->folder(), log, store.get());
      if (!folder.ok()) return folder.status();
      meshes = *std::move(folder);
    }
    if (absl::Status status = keep_memory_within(memory_share(options), scratch_folder(options)); !status.ok()) {
      if (options.memory_bytes > 0) return status;
      log->warn("memory is not bounded: {}", std::string(status.message()));
    }
    const std::size_t descriptors = raise_descriptor_limit();
    ServerOptions bounded = options;
    bounded.max_connections = std::min(options.max_connections, share_descriptors(descriptors).connections);
    auto server = std::make_unique<GrpcServer>(bounded, std::move(log), std::move(cache), std::move(meshes), std::move(store),
                                               std::move(tokens), *std::move(proxies), *std::move(tls));
    absl::Status status = server->listen(descriptors);
    if (status.ok() && !options.http.empty()) status = server->listen_http(descriptors);
    if (status.ok() && !options.admin.empty()) status = server->listen_admin();
    if (!status.ok()) return status;
    return server;
  });
}

}  // namespace curvecast::server
