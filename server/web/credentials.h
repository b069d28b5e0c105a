// The TLS files that a server is started with.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <optional>
#include <string>

#include "proto/tls/pem_files.h"
#include "server/base/replaceable.h"

namespace grpc {
class ServerCredentials;
}

namespace curvecast::server {

struct ServerOptions;

/// What connections are encrypted with, as PEM.
struct ServerTls {
  tls::Identity identity;
  std::string client_authorities = {};  // only clients for whom these vouch may connect; empty: all
};

/// Reads the options' TLS files; returns nothing where there are none: no encryption. InvalidArgument for a certificate without
/// key or the other way round, and errors as of tls::read_identity().
absl::StatusOr<std::optional<ServerTls>> read_server_tls(const ServerOptions& options);

/// Credentials for one gRPC port: each new connection is encrypted with what `tls` holds then. Null: not encrypted. What `tls`
/// holds may change, but not whether it has client_authorities.
std::shared_ptr<grpc::ServerCredentials> make_credentials(std::shared_ptr<const Replaceable<ServerTls>> tls);

}  // namespace curvecast::server
