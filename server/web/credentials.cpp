#include "server/web/credentials.h"

#include <grpcpp/security/server_credentials.h>

#include <utility>

#include "server/base/options.h"

namespace curvecast::server {

absl::StatusOr<std::optional<ServerTls>> read_server_tls(const ServerOptions& options) {
  if (options.tls_cert.empty() && options.tls_key.empty()) {
    if (options.tls_client_ca.empty()) return std::nullopt;
    return absl::InvalidArgumentError(
        "clients can only be asked for certificates where the server has one: tls-cert and tls-key");
  }
  if (options.tls_cert.empty() || options.tls_key.empty()) {
    return absl::InvalidArgumentError("tls-cert and tls-key belong together: one is missing");
  }
  absl::StatusOr<tls::Identity> identity = tls::read_identity(options.tls_cert, options.tls_key);
  if (!identity.ok()) return identity.status();
  ServerTls tls{*std::move(identity)};
  if (!options.tls_client_ca.empty()) {
    absl::StatusOr<std::string> authorities = tls::read_authorities(options.tls_client_ca);
    if (!authorities.ok()) return authorities.status();
    tls.client_authorities = *std::move(authorities);
  }
  return tls;
}

std::shared_ptr<grpc::ServerCredentials> make_credentials(const std::optional<ServerTls>& tls) {
  if (!tls) return grpc::InsecureServerCredentials();
  grpc::SslServerCredentialsOptions ssl;
  ssl.pem_key_cert_pairs.push_back({tls->identity.key, tls->identity.certificates});
  if (!tls->client_authorities.empty()) {
    ssl.pem_root_certs = tls->client_authorities;
    ssl.client_certificate_request = GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
  }
  return grpc::SslServerCredentials(ssl);
}

}  // namespace curvecast::server
