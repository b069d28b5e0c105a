// SPDX-License-Identifier: Apache-2.0
// One line to a Curvecast server: calls with deadlines, retries and cancellation, errors as absl::Status.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "retry.h"

namespace grpc {
class Channel;
}

namespace curvecast::client {

struct RetryPolicy {
  int attempts = 5;                            // in all, at least 1
  std::chrono::milliseconds first_delay{100};  // doubles after every attempt, with jitter
  std::chrono::milliseconds longest_delay{2000};
};

struct ConnectionOptions {
  std::string token;  // that the server knows this client by, sent with every call; empty: none
  RetryPolicy retry;
  std::chrono::milliseconds short_timeout{30'000};  // calls that only look something up
  std::chrono::milliseconds long_timeout{600'000};  // calls that compute or move data; preprocessing has no deadline
};

/// What gRPC's standard health service says of a server.
enum class Health {
  kServing,
  kNotServing,  // its meshes are being prepared, or it is about to end
};

/// Fills `out` with the bytes from `offset` on. Called again from where the server has lost track when an upload is repeated.
using ReadAt = std::function<absl::Status(std::uint64_t offset, std::span<char> out)>;
using OnBytes = std::function<void(std::uint64_t sent)>;
using OnProgress = std::function<void(const v1::Progress& progress)>;

/// A running StreamViews call. One thread may write while another reads.
class ViewCall {
 public:
  virtual ~ViewCall() = default;  // cancels what still runs
  /// False when the call is over.
  virtual bool write(const v1::StreamViewsRequest& request) = 0;
  virtual bool read(v1::StreamViewsResponse* response) = 0;
  virtual void writes_done() = 0;
  virtual void cancel() = 0;
  /// How the call ended; after read() has said false.
  virtual absl::Status finish() = 0;
};

/// An interface, so that clients can be tested without a server. Errors are the server's (see retry_after() in retry.h), or
/// Unavailable, DeadlineExceeded, and Cancelled once `stop` is requested. Thread-safe.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual absl::StatusOr<v1::UploadMeshResponse> upload_mesh(const v1::UploadHeader& header, const ReadAt& read,
                                                             const OnBytes& on_bytes, std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::GetMeshResponse> get_mesh(const v1::GetMeshRequest& request, std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::ListMeshesResponse> list_meshes(const v1::ListMeshesRequest& request, std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::ListMeshReferencesResponse> list_mesh_references(const v1::ListMeshReferencesRequest& request,
                                                                              std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::InspectMeshResponse> inspect_mesh(const v1::InspectMeshRequest& request, std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::RenderResponse> render(const v1::RenderRequest& request, std::stop_token stop) = 0;
  /// All messages of the answer, in order.
  virtual absl::StatusOr<std::vector<v1::GetParameterMeshResponse>> get_parameter_mesh(const v1::GetParameterMeshRequest& request,
                                                                                       std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::Session> create_session(const v1::CreateSessionRequest& request, const OnProgress& on_progress,
                                                     std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::GetSessionResponse> get_session(const v1::GetSessionRequest& request, std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::ListSessionsResponse> list_sessions(const v1::ListSessionsRequest& request,
                                                                 std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::UpdateSessionResponse> update_session(const v1::UpdateSessionRequest& request,
                                                                   std::stop_token stop) = 0;
  virtual absl::Status close_session(const v1::CloseSessionRequest& request, std::stop_token stop) = 0;
  /// All messages of the answer, in order.
  virtual absl::StatusOr<std::vector<v1::ResampleResponse>> resample(const v1::ResampleRequest& request,
                                                                     std::stop_token stop) = 0;
  /// All messages of the answer but those of progress, in order.
  virtual absl::StatusOr<std::vector<v1::ScatterResponse>> scatter(const v1::ScatterRequest& request,
                                                                   const OnProgress& on_progress, std::stop_token stop) = 0;
  /// All messages of the answer but those of progress, in order.
  virtual absl::StatusOr<std::vector<v1::FindNeighboursResponse>> find_neighbours(const v1::FindNeighboursRequest& request,
                                                                                  const OnProgress& on_progress,
                                                                                  std::stop_token stop) = 0;
  /// All messages of the answer, in order.
  virtual absl::StatusOr<std::vector<v1::GetCurveResponse>> get_curve(const v1::GetCurveRequest& request,
                                                                      std::stop_token stop) = 0;
  /// All messages of the answer but those of progress, in order.
  virtual absl::StatusOr<std::vector<v1::RemeshResponse>> remesh(const v1::RemeshRequest& request, const OnProgress& on_progress,
                                                                 std::stop_token stop) = 0;
  /// All messages of the answer, in order.
  virtual absl::StatusOr<std::vector<v1::GetSurfaceResponse>> get_surface(const v1::GetSurfaceRequest& request,
                                                                          std::stop_token stop) = 0;
  virtual absl::StatusOr<v1::Measures> measure(const v1::MeasureRequest& request, const OnProgress& on_progress,
                                               std::stop_token stop) = 0;
  /// How the server is now: not repeated. Unimplemented when it is another server than Curvecast's.
  virtual absl::StatusOr<Health> check_health(std::chrono::milliseconds timeout, std::stop_token stop) = 0;
  /// `open` is what the caller is going to write first.
  virtual std::unique_ptr<ViewCall> stream_views(const v1::OpenView& open, std::stop_token stop) = 0;
  /// Before what was lost is tried again: for `delay`, in which a lost connection is made again. False when `stop` was requested
  /// meanwhile.
  virtual bool pause(std::chrono::milliseconds delay, const std::stop_token& stop) { return sleep_for(delay, stop); }
};

/// A channel over TCP, without encryption; "host:port". Connects at the first call.
std::shared_ptr<grpc::Channel> tcp_channel(const std::string& address);

/// PEM files for a channel.
struct TlsFiles {
  std::string ca;    // of those whose servers are believed; empty: those that this machine believes
  std::string cert;  // what this client shows to servers that ask for it, and its key; empty: nothing
  std::string key;

  bool is_empty() const { return ca.empty() && cert.empty() && key.empty(); }
};

/// The same with TLS. Fails where the files cannot be used, see tls::read_identity(); whether the two sides believe each other
/// turns out at the first call (Unavailable).
absl::StatusOr<std::shared_ptr<grpc::Channel>> tls_channel(const std::string& address, const TlsFiles& files);

/// Repeats idempotent calls (all but close_session, check_health and stream_views) that were lost, see is_lost() in retry.h.
std::shared_ptr<Connection> make_connection(std::shared_ptr<grpc::Channel> channel, const ConnectionOptions& options = {});

}  // namespace curvecast::client
