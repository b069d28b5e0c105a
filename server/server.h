// The gRPC server: sessions and views for many clients, over TCP, in this process, or both.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <memory>

#include "server/base/options.h"

namespace grpc {
class Channel;
}

namespace curvecast::server {

/// Thread-safe after start(). Frames of StreamViews are up to 32 MiB: let the client's channel receive that much.
class Server {
 public:
  /// Listens, or fails with Unavailable (an address in use), InvalidArgument (malformed address, negative threads, TLS files,
  /// proxies, a store without a cache or with no such URL), NotFound (a TLS file) or FailedPrecondition (the cache's folder
  /// cannot be used).
  static absl::StatusOr<std::unique_ptr<Server>> start(const ServerOptions& options);
  virtual ~Server() = default;  // shuts down at once where shutdown() was not called

  /// The TCP port listened on; 0 when in-process only.
  virtual int port() const = 0;
  /// The TCP port of HTTP; 0 without.
  virtual int http_port() const = 0;
  /// The TCP port of probes and metrics; 0 without.
  virtual int admin_port() const = 0;
  /// From now on /readyz and health say so, until retire() or shutdown().
  virtual void set_ready() = 0;
  /// A channel that reaches this server without a socket.
  virtual std::shared_ptr<grpc::Channel> in_process_channel() = 0;
  /// Reads the files of tokens and certificates anew, and writes to the log what came of it. Calls are refused from now on where
  /// their tokens are not in the file any more, and streams of views and WebSockets of such tokens end; new connections get the
  /// new certificates. What cannot be read, or is wrong, stays as it was; errors, of which the first is returned, name the file.
  virtual absl::Status reload() = 0;
  /// Health says NOT_SERVING and /readyz that the server ends, so that balancers send no more clients. All else goes on.
  virtual void retire() = 0;
  /// As retire(); streams of views end with UNAVAILABLE, other running calls get `drain` to end, then are cancelled;
  /// preprocessing stops; sessions on their way to the cache get there. Idempotent.
  virtual void shutdown(std::chrono::milliseconds drain) = 0;
  /// As shutdown(), but waits no longer than `drain` and `patience` together: DeadlineExceeded where that was not enough, because
  /// the disk of the cache does not get on, say. The log names the sessions that are not in the cache. What is under way goes on
  /// as long as the process, and whoever destroys the server waits for it.
  virtual absl::Status shutdown_within(std::chrono::milliseconds drain, std::chrono::milliseconds patience) = 0;
};

}  // namespace curvecast::server
