#pragma once

#include <absl/status/statusor.h>

#include <memory>

namespace grpc {
class ServerCredentials;
}

namespace curvecast::server {

struct ServerOptions;

/// What the options' TLS files say; without any, that there is no encryption. InvalidArgument for one without the other, and
/// errors as of tls::read_identity().
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> make_credentials(const ServerOptions& options);

}  // namespace curvecast::server
