#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <optional>
#include <string>

#include "proto/tls/pem_files.h"

namespace grpc {
class ServerCredentials;
}

namespace curvecast::server {

struct ServerOptions;

/// With what connections are encrypted, as PEM.
struct ServerTls {
  tls::Identity identity;
  std::string client_authorities = {};  // only clients for whom these vouch may connect; empty: all
};

/// What the options' TLS files hold; none: no encryption. InvalidArgument for one without the other, and errors as of
/// tls::read_identity().
absl::StatusOr<std::optional<ServerTls>> read_server_tls(const ServerOptions& options);

std::shared_ptr<grpc::ServerCredentials> make_credentials(const std::optional<ServerTls>& tls);

}  // namespace curvecast::server
