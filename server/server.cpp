#include "server/server.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/logger.h>

#include <mutex>
#include <utility>

#include "server/engine.h"
#include "server/guarded.h"
#include "server/log.h"
#include "server/service.h"

namespace curvecast::server {
namespace {

constexpr int kKeepaliveMs = 30'000;         // between pings to a silent client
constexpr int kKeepaliveTimeoutMs = 10'000;  // until it counts as gone
constexpr int kMinPingIntervalMs = 5'000;    // what a client may do
constexpr int kMaxCallsPerConnection = 256;

absl::Status check_address(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  int port = 0;
  if (colon == std::string::npos || colon == 0 || !absl::SimpleAtoi(address.substr(colon + 1), &port) || port < 0 ||
      port > 65'535) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", address, "\" is not an address to listen on; write HOST:PORT, such as 127.0.0.1:50051"));
  }
  return absl::OkStatus();
}

class GrpcServer final : public Server {
 public:
  GrpcServer(const ServerOptions& options, std::shared_ptr<spdlog::logger> log, std::unique_ptr<SessionCache> cache)
      : engine_(options, std::move(log), std::move(cache)), service_(engine_) {}
  ~GrpcServer() override { shutdown(std::chrono::milliseconds(0)); }

  absl::Status listen(const std::string& address) {
    grpc::EnableDefaultHealthCheckService(true);
    static std::once_flag reflection;  // the plugin is the whole process's and counts its own calls
    std::call_once(reflection, grpc::reflection::InitProtoReflectionServerBuilderPlugin);
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);  // an address in use is an error
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingIntervalMs);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxCallsPerConnection);
    if (!address.empty()) builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port_);
    grpc_ = builder.BuildAndStart();
    if (grpc_ == nullptr || (!address.empty() && port_ == 0)) {
      return absl::UnavailableError(
          absl::StrCat("cannot listen on ", address, ": the address is in use or not one of this machine's"));
    }
    if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) {
      health->SetServingStatus(v1::CurvecastService::service_full_name(), true);
    }
    engine_.log->info("serving on {}", address.empty() ? "this process" : absl::StrCat(address, ", port ", port_));
    return absl::OkStatus();
  }

  int port() const override { return port_; }

  std::shared_ptr<grpc::Channel> in_process_channel() override {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    return grpc_->InProcessChannel(arguments);
  }

  void shutdown(std::chrono::milliseconds drain) override {
    std::call_once(shutdown_, [&] {
      if (grpc_ != nullptr) {
        if (grpc::HealthCheckServiceInterface* health = grpc_->GetHealthCheckService()) health->Shutdown();
        // A conversation has no end of its own to wait for.
        engine_.stop_streams(absl::UnavailableError("the server is shutting down; reconnect"));
        grpc_->Shutdown(std::chrono::system_clock::now() + drain);
        engine_.log->info("stopped");
      }
      engine_.refiner.stop();
      engine_.rank_jobs.stop();
      engine_.views.stop();
      engine_.preprocessing.stop();
      if (engine_.cache != nullptr) engine_.cache->stop();
    });
  }

 private:
  Engine engine_;
  Service service_;
  std::unique_ptr<grpc::Server> grpc_;
  int port_ = 0;
  std::once_flag shutdown_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::start(const ServerOptions& options) {
  if (options.threads < 0) {
    return absl::InvalidArgumentError(absl::StrCat("threads is ", options.threads, "; 0 means one per core"));
  }
  if (!options.listen.empty()) {
    if (absl::Status status = check_address(options.listen); !status.ok()) return status;
  }
  return guarded([&]() -> absl::StatusOr<std::unique_ptr<Server>> {
    std::shared_ptr<spdlog::logger> log = make_logger(options.log, options.verbose);
    std::unique_ptr<SessionCache> cache;
    if (!options.cache.empty()) {
      absl::StatusOr<std::unique_ptr<SessionCache>> opened = SessionCache::open(options.cache, options.cache_bytes, log);
      if (!opened.ok()) return opened.status();
      cache = *std::move(opened);
    }
    auto server = std::make_unique<GrpcServer>(options, std::move(log), std::move(cache));
    if (absl::Status status = server->listen(options.listen); !status.ok()) return status;
    return server;
  });
}

}  // namespace curvecast::server
