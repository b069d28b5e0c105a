#include "server/credentials.h"

#include <grpcpp/security/server_credentials.h>

#include <utility>

#include "proto/tls/pem_files.h"
#include "server/server.h"

namespace curvecast::server {

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> make_credentials(const ServerOptions& options) {
  if (options.tls_cert.empty() && options.tls_key.empty()) {
    if (options.tls_client_ca.empty()) return grpc::InsecureServerCredentials();
    return absl::InvalidArgumentError(
        "clients can only be asked for certificates where the server has one: tls-cert and tls-key");
  }
  if (options.tls_cert.empty() || options.tls_key.empty()) {
    return absl::InvalidArgumentError("tls-cert and tls-key belong together: one is missing");
  }
  absl::StatusOr<tls::Identity> identity = tls::read_identity(options.tls_cert, options.tls_key);
  if (!identity.ok()) return identity.status();
  grpc::SslServerCredentialsOptions ssl;
  ssl.pem_key_cert_pairs.push_back({std::move(identity->key), std::move(identity->certificates)});
  if (!options.tls_client_ca.empty()) {
    absl::StatusOr<std::string> authorities = tls::read_authorities(options.tls_client_ca);
    if (!authorities.ok()) return authorities.status();
    ssl.pem_root_certs = *std::move(authorities);
    ssl.client_certificate_request = GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
  }
  return grpc::SslServerCredentials(ssl);
}

}  // namespace curvecast::server
