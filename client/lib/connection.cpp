// SPDX-License-Identifier: Apache-2.0
#include "client/lib/connection.h"

#include <absl/strings/str_cat.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "client/lib/encoded_sample.h"
#include "client/lib/health.h"
#include "client/lib/protocol.h"
#include "client/lib/retry.h"
#include "client/lib/routing_key.h"
#include "client/lib/rpc_status.h"
#include "curvecast/v1/curvecast.grpc.pb.h"
#include "proto/tls/pem_files.h"

namespace curvecast::client {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kChunkBytes = kMaxChunkBytes / 2;            // of an upload
constexpr int kMaxMessageBytes = 2 * kMaxFrameBytes;               // received: frames have more than their points
constexpr std::uint64_t kMaxAnswerBytes = std::uint64_t{8} << 30;  // of a parameter mesh: about 80 million triangles
constexpr int kKeepaliveMs = 20'000;         // between pings during a call; servers allow one every 5 seconds
constexpr int kKeepaliveTimeoutMs = 10'000;  // until a silent server counts as lost
// Between attempts to reach a server that is not there. gRPC's own are up to two minutes long: until then all calls fail, though
// the server be back.
constexpr int kFirstReconnectMs = 100, kLongestReconnectMs = 2'000;
constexpr milliseconds kStopLook{20};  // while gRPC waits, which cannot be stopped

template <typename T>
absl::Status status_of(const absl::StatusOr<T>& result) {
  return result.status();
}

/// The context of one call, cancelled when `stop` is requested.
class Call {
 public:
  /// `about`: the request, or that which begins the call.
  template <typename Request>
  Call(const ConnectionOptions& options, const Request& about, const std::stop_token& stop, std::optional<milliseconds> timeout)
      : on_stop_(stop, Cancel{&context_}) {
    if (const std::string_view key = routing_key(about); !key.empty()) context_.AddMetadata(kRoutingKey, std::string(key));
    if (!options.token.empty()) context_.AddMetadata("authorization", "Bearer " + options.token);
    if (timeout) context_.set_deadline(std::chrono::system_clock::now() + *timeout);
  }
  grpc::ClientContext* context() { return &context_; }

 private:
  struct Cancel {
    grpc::ClientContext* context;
    void operator()() const { context->TryCancel(); }
  };
  grpc::ClientContext context_;
  std::stop_callback<Cancel> on_stop_;
};

class GrpcViewCall : public ViewCall {
 public:
  GrpcViewCall(v1::CurvecastService::Stub& stub, const ConnectionOptions& options, const v1::OpenView& open,
               const std::stop_token& stop)
      : call_(options, open, stop, std::nullopt), stream_(stub.StreamViews(call_.context())) {}
  ~GrpcViewCall() override {
    if (finished_) return;
    GrpcViewCall::cancel();
    v1::StreamViewsResponse rest;
    while (stream_->Read(&rest)) {
    }
    stream_->Finish();
  }
  bool write(const v1::StreamViewsRequest& request) override { return stream_->Write(request); }
  bool read(v1::StreamViewsResponse* response) override { return stream_->Read(response); }
  void writes_done() override { stream_->WritesDone(); }
  void cancel() override { call_.context()->TryCancel(); }
  absl::Status finish() override {
    finished_ = true;
    return to_absl(stream_->Finish());
  }

 private:
  Call call_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamViewsRequest, v1::StreamViewsResponse>> stream_;
  bool finished_ = false;
};

/// All messages of an answer but those that tell of progress. A server that sends on and on must not fill this machine's memory.
template <typename Response>
absl::StatusOr<std::vector<Response>> read_all(grpc::ClientReader<Response>& reader, Call& call, const char* what,
                                               const OnProgress& on_progress = {}) {
  std::vector<Response> responses;
  Response response;
  std::uint64_t bytes = 0;
  while (reader.Read(&response)) {
    if constexpr (requires { response.has_progress(); }) {
      if (response.has_progress()) {
        if (on_progress) on_progress(response.progress());
        continue;
      }
    }
    bytes += response.ByteSizeLong() + sizeof response;
    if (bytes > kMaxAnswerBytes) {
      call.context()->TryCancel();
      while (reader.Read(&response)) {
      }
      reader.Finish();
      return absl::ResourceExhaustedError(absl::StrCat("the server sent ", what, " of more than ", kMaxAnswerBytes, " bytes"));
    }
    responses.push_back(std::move(response));
    response.Clear();
  }
  if (absl::Status status = to_absl(reader.Finish()); !status.ok()) return status;
  return responses;
}

/// Hands every message that tells of progress to `on_progress`, and all messages to `take`.
template <typename Response, typename Take>
absl::Status read_progress(grpc::ClientReader<Response>& reader, const OnProgress& on_progress, const Take& take) {
  Response response;
  while (reader.Read(&response)) {
    if (response.has_progress() && on_progress) on_progress(response.progress());
    take(response);
  }
  return to_absl(reader.Finish());
}

class GrpcConnection : public Connection {
 public:
  GrpcConnection(std::shared_ptr<grpc::Channel> channel, const ConnectionOptions& options)
      : stub_(v1::CurvecastService::NewStub(channel)), health_(channel), channel_(std::move(channel)), options_(options) {}

  absl::StatusOr<v1::UploadMeshResponse> upload_mesh(const v1::UploadHeader& header, const ReadAt& read, const OnBytes& on_bytes,
                                                     std::stop_token stop) override {
    v1::UploadHeader rest = header;
    bool is_first = true;
    return with_retry(stop, [&] {
      // What has come before the connection broke need not be sent again.
      if (!std::exchange(is_first, false)) rest.set_offset(received(header, stop));
      return upload_once(rest, read, on_bytes, stop);
    });
  }

  absl::StatusOr<v1::GetMeshResponse> get_mesh(const v1::GetMeshRequest& request, std::stop_token stop) override {
    return unary<v1::GetMeshResponse>(&v1::CurvecastService::Stub::GetMesh, request, options_.short_timeout, stop);
  }

  absl::StatusOr<v1::ListMeshesResponse> list_meshes(const v1::ListMeshesRequest& request, std::stop_token stop) override {
    return unary<v1::ListMeshesResponse>(&v1::CurvecastService::Stub::ListMeshes, request, options_.short_timeout, stop);
  }

  absl::StatusOr<v1::ListMeshReferencesResponse> list_mesh_references(const v1::ListMeshReferencesRequest& request,
                                                                      std::stop_token stop) override {
    return unary<v1::ListMeshReferencesResponse>(&v1::CurvecastService::Stub::ListMeshReferences, request, options_.long_timeout,
                                                 stop);
  }

  absl::StatusOr<v1::InspectMeshResponse> inspect_mesh(const v1::InspectMeshRequest& request, std::stop_token stop) override {
    return unary<v1::InspectMeshResponse>(&v1::CurvecastService::Stub::InspectMesh, request, options_.long_timeout, stop);
  }

  absl::StatusOr<v1::RenderResponse> render(const v1::RenderRequest& request, std::stop_token stop) override {
    return unary<v1::RenderResponse>(&v1::CurvecastService::Stub::Render, request, options_.long_timeout, stop);
  }

  absl::StatusOr<std::vector<v1::GetParameterMeshResponse>> get_parameter_mesh(const v1::GetParameterMeshRequest& request,
                                                                               std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::GetParameterMeshResponse>> {
      Call call(options_, request, stop, std::nullopt);
      return read_all<v1::GetParameterMeshResponse>(*stub_->GetParameterMesh(call.context(), request), call, "a parameter mesh");
    });
  }

  absl::StatusOr<v1::Session> create_session(const v1::CreateSessionRequest& request, const OnProgress& on_progress,
                                             std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<v1::Session> {
      Call call(options_, request, stop, std::nullopt);
      std::optional<v1::Session> session;
      const absl::Status status = read_progress<v1::CreateSessionResponse>(*stub_->CreateSession(call.context(), request),
                                                                           on_progress, [&](auto& response) {
                                                                             if (response.has_session())
                                                                               session = std::move(*response.mutable_session());
                                                                           });
      if (!status.ok()) return status;
      if (!session) return absl::DataLossError("the server ended CreateSession without a session");
      return *std::move(session);
    });
  }

  absl::StatusOr<v1::GetSessionResponse> get_session(const v1::GetSessionRequest& request, std::stop_token stop) override {
    return unary<v1::GetSessionResponse>(&v1::CurvecastService::Stub::GetSession, request, options_.short_timeout, stop);
  }

  absl::StatusOr<v1::ListSessionsResponse> list_sessions(const v1::ListSessionsRequest& request, std::stop_token stop) override {
    return unary<v1::ListSessionsResponse>(&v1::CurvecastService::Stub::ListSessions, request, options_.short_timeout, stop);
  }

  absl::StatusOr<v1::UpdateSessionResponse> update_session(const v1::UpdateSessionRequest& request,
                                                           std::stop_token stop) override {
    return unary<v1::UpdateSessionResponse>(&v1::CurvecastService::Stub::UpdateSession, request, options_.short_timeout, stop);
  }

  absl::Status close_session(const v1::CloseSessionRequest& request, std::stop_token stop) override {
    Call call(options_, request, stop, options_.short_timeout);
    v1::CloseSessionResponse response;
    return to_absl(stub_->CloseSession(call.context(), request, &response));
  }

  absl::StatusOr<std::vector<v1::ResampleResponse>> resample(const v1::ResampleRequest& request, std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::ResampleResponse>> {
      Call call(options_, request, stop, options_.long_timeout);
      const auto reader = stub_->Resample(call.context(), request);
      std::vector<v1::ResampleResponse> responses;
      v1::ResampleResponse response;
      std::uint64_t points = 0;
      const std::uint64_t most = most_points(request.sample());
      while (reader->Read(&response)) {
        points += response.points().count();
        // A server that sends on and on must not fill this machine's memory.
        if (points > most || responses.size() > most) {
          call.context()->TryCancel();
          while (reader->Read(&response)) {
          }
          reader->Finish();
          return absl::DataLossError(absl::StrCat("the server sent more than the ", most, " points asked for"));
        }
        responses.push_back(std::move(response));
        response.Clear();
      }
      if (absl::Status status = to_absl(reader->Finish()); !status.ok()) return status;
      return responses;
    });
  }

  absl::StatusOr<std::vector<v1::ScatterResponse>> scatter(const v1::ScatterRequest& request, const OnProgress& on_progress,
                                                           std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::ScatterResponse>> {
      Call call(options_, request, stop, std::nullopt);
      return read_all<v1::ScatterResponse>(*stub_->Scatter(call.context(), request), call, "points", on_progress);
    });
  }

  absl::StatusOr<std::vector<v1::FindNeighboursResponse>> find_neighbours(const v1::FindNeighboursRequest& request,
                                                                          const OnProgress& on_progress,
                                                                          std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::FindNeighboursResponse>> {
      Call call(options_, request, stop, options_.long_timeout);
      return read_all<v1::FindNeighboursResponse>(*stub_->FindNeighbours(call.context(), request), call, "neighbours",
                                                  on_progress);
    });
  }

  absl::StatusOr<std::vector<v1::GetCurveResponse>> get_curve(const v1::GetCurveRequest& request, std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::GetCurveResponse>> {
      Call call(options_, request, stop, options_.long_timeout);
      return read_all<v1::GetCurveResponse>(*stub_->GetCurve(call.context(), request), call, "a curve");
    });
  }

  absl::StatusOr<std::vector<v1::RemeshResponse>> remesh(const v1::RemeshRequest& request, const OnProgress& on_progress,
                                                         std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::RemeshResponse>> {
      Call call(options_, request, stop, options_.long_timeout);
      return read_all<v1::RemeshResponse>(*stub_->Remesh(call.context(), request), call, "a mesh", on_progress);
    });
  }

  absl::StatusOr<std::vector<v1::GetSurfaceResponse>> get_surface(const v1::GetSurfaceRequest& request,
                                                                  std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<std::vector<v1::GetSurfaceResponse>> {
      Call call(options_, request, stop, options_.long_timeout);
      return read_all<v1::GetSurfaceResponse>(*stub_->GetSurface(call.context(), request), call, "a surface");
    });
  }

  absl::StatusOr<v1::Measures> measure(const v1::MeasureRequest& request, const OnProgress& on_progress,
                                       std::stop_token stop) override {
    return with_retry(stop, [&]() -> absl::StatusOr<v1::Measures> {
      Call call(options_, request, stop, std::nullopt);
      std::optional<v1::Measures> measures;
      const absl::Status status =
          read_progress<v1::MeasureResponse>(*stub_->Measure(call.context(), request), on_progress, [&](auto& response) {
            if (response.has_measures()) measures = std::move(*response.mutable_measures());
          });
      if (!status.ok()) return status;
      if (!measures) return absl::DataLossError("the server ended Measure without measures");
      return *std::move(measures);
    });
  }

  absl::StatusOr<Health> check_health(milliseconds timeout, std::stop_token stop) override {
    Call call(options_, google::protobuf::StringValue(), stop, timeout);
    return health_.check(call.context());
  }

  std::unique_ptr<ViewCall> stream_views(const v1::OpenView& open, std::stop_token stop) override {
    return std::make_unique<GrpcViewCall>(*stub_, options_, open, stop);
  }

  // gRPC sees that a connection has come about only while somebody waits for it (1.51: every five seconds otherwise), and until
  // then all calls fail at once.
  bool pause(milliseconds delay, const std::stop_token& stop) override {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + delay;
    const auto rest = [end] { return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(end - Clock::now())); };
    while (!stop.stop_requested() && rest() > milliseconds(0)) {
      const grpc_connectivity_state state = channel_->GetState(false);
      if (state != GRPC_CHANNEL_CONNECTING && state != GRPC_CHANNEL_TRANSIENT_FAILURE) break;
      channel_->WaitForStateChange(state, std::chrono::system_clock::now() + std::min(rest(), kStopLook));
    }
    return sleep_for(rest(), stop);
  }

 private:
  template <typename Response, typename Request, typename Method>
  absl::StatusOr<Response> unary(Method method, const Request& request, milliseconds timeout, const std::stop_token& stop) {
    return with_retry(stop, [&]() -> absl::StatusOr<Response> {
      Call call(options_, request, stop, timeout);
      Response response;
      if (absl::Status status = to_absl(((*stub_).*method)(call.context(), request, &response)); !status.ok()) return status;
      return response;
    });
  }

  /// Calls `attempt` until it succeeds, fails for good, or the policy is exhausted.
  template <typename Attempt>
  auto with_retry(const std::stop_token& stop, const Attempt& attempt) -> decltype(attempt()) {
    Backoff backoff(options_.retry.first_delay, options_.retry.longest_delay);
    for (int i = 1;; ++i) {
      auto result = attempt();
      if (result.ok()) return result;
      if (stop.stop_requested()) return absl::CancelledError("cancelled");
      if (i >= options_.retry.attempts || !is_lost(status_of(result))) return result;
      if (!pause(backoff.next(), stop)) return absl::CancelledError("cancelled");
    }
  }

  /// Bytes that the server has of a file, as far as it can tell.
  std::uint64_t received(const v1::UploadHeader& header, const std::stop_token& stop) {
    if (header.mesh_id().empty()) return 0;
    Call call(options_, header, stop, options_.short_timeout);
    v1::GetUploadRequest request;
    request.set_mesh_id(header.mesh_id());
    v1::GetUploadResponse response;
    const bool is_known = stub_->GetUpload(call.context(), request, &response).ok();
    return is_known && response.received() <= header.size() ? response.received() : 0;
  }

  absl::StatusOr<v1::UploadMeshResponse> upload_once(const v1::UploadHeader& header, const ReadAt& read, const OnBytes& on_bytes,
                                                     const std::stop_token& stop) {
    Call call(options_, header, stop, options_.long_timeout);
    v1::UploadMeshResponse response;
    const auto writer = stub_->UploadMesh(call.context(), &response);
    v1::UploadMeshRequest message;
    *message.mutable_header() = header;
    bool open = writer->Write(message);
    for (std::uint64_t sent = header.offset(); open && sent < header.size();) {
      std::string& chunk = *message.mutable_chunk();
      chunk.resize(std::min<std::uint64_t>(kChunkBytes, header.size() - sent));
      if (absl::Status status = read(sent, chunk); !status.ok()) {
        call.context()->TryCancel();
        writer->Finish();
        return status;
      }
      open = writer->Write(message);
      if (open) sent += chunk.size();
      if (open && on_bytes) on_bytes(sent);
    }
    writer->WritesDone();
    if (absl::Status status = to_absl(writer->Finish()); !status.ok()) return status;
    return response;
  }

  std::unique_ptr<v1::CurvecastService::Stub> stub_;
  HealthStub health_;
  const std::shared_ptr<grpc::Channel> channel_;
  ConnectionOptions options_;
};

std::shared_ptr<grpc::Channel> make_channel(const std::string& address,
                                            const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kFirstReconnectMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kLongestReconnectMs);
  return grpc::CreateCustomChannel(address, credentials, arguments);
}

}  // namespace

std::shared_ptr<grpc::Channel> tcp_channel(const std::string& address) {
  return make_channel(address, grpc::InsecureChannelCredentials());
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> tls_channel(const std::string& address, const TlsFiles& files) {
  if (files.cert.empty() != files.key.empty()) {
    return absl::InvalidArgumentError("tls-cert and tls-key belong together: one is missing");
  }
  grpc::SslCredentialsOptions options;
  if (!files.ca.empty()) {
    absl::StatusOr<std::string> authorities = tls::read_authorities(files.ca);
    if (!authorities.ok()) return authorities.status();
    options.pem_root_certs = *std::move(authorities);
  }
  if (!files.cert.empty()) {
    absl::StatusOr<tls::Identity> identity = tls::read_identity(files.cert, files.key);
    if (!identity.ok()) return identity.status();
    options.pem_cert_chain = std::move(identity->certificates);
    options.pem_private_key = std::move(identity->key);
  }
  return make_channel(address, grpc::SslCredentials(options));
}

std::shared_ptr<Connection> make_connection(std::shared_ptr<grpc::Channel> channel, const ConnectionOptions& options) {
  return std::make_shared<GrpcConnection>(std::move(channel), options);
}

}  // namespace curvecast::client
