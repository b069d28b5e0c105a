// The TCP port of gRPC.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/server_builder.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>

#include "server/net/connection_table.h"
#include "server/net/port_listener.h"
#include "server/net/port_probe.h"

namespace curvecast::server {

/// Accepts connections and hands them to gRPC, which would close its own listener for ever when once there is no descriptor left
/// (1.51, grpc#20418). Thread-safe but for add_to(), open() and close().
class GrpcPort {
 public:
  /// Errors as of PortListener::bind(). `connections` counts them, and must outlive the port; one whose descriptor would be
  /// `most` or higher waits for a lower one, and so do those behind it; after a second it is closed.
  static absl::StatusOr<std::unique_ptr<GrpcPort>> bind(const std::string& address, ConnectionTable& connections,
                                                        std::size_t most);

  /// Before the server is built.
  void add_to(grpc::ServerBuilder& builder, std::shared_ptr<grpc::ServerCredentials> credentials);
  /// Once it is. `is_proxy`: see PortListener.
  void open(PortListener::IsProxy is_proxy);
  /// Accepts no more connections: before the server shuts down. Idempotent.
  void close();

  int port() const { return listener_->port(); }
  /// Whether gRPC has answered a connection of late, or needs not any more: closed on purpose. At once.
  bool answers() const { return is_closed_ || probe_->answers(); }

 private:
  GrpcPort(std::unique_ptr<PortListener> listener, ConnectionTable& connections, std::size_t most);
  void take(int listener, int descriptor, const std::string& peer, const std::string& client);
  /// Waits until a connection can have a descriptor below `most`, and gives it that. False: there is none.
  bool lower(int& descriptor) const;

  ConnectionTable& connections_;
  const std::size_t most_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  const std::unique_ptr<PortListener> listener_;
  std::unique_ptr<PortProbe> probe_;  // null: not open yet
  std::atomic<bool> is_closed_ = false;
};

}  // namespace curvecast::server
