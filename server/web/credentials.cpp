#include "server/web/credentials.h"

#include <grpc/grpc.h>
#include <grpc/grpc_security.h>
#include <grpcpp/security/server_credentials.h>

#include <utility>

#include "server/base/options.h"

namespace curvecast::server {
namespace {

/// gRPC's C++ interface knows only certificates for ever; its core asks for new ones with each connection.
class ReplaceableCredentials final : public grpc::ServerCredentials {
 public:
  explicit ReplaceableCredentials(std::shared_ptr<const Replaceable<ServerTls>> tls) : tls_(std::move(tls)) {
    const auto wanted = tls_->get()->client_authorities.empty() ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                                                                : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
    made_ = grpc_ssl_server_credentials_create_with_options(
        grpc_ssl_server_credentials_create_options_using_config_fetcher(wanted, fetch, this));
  }
  ReplaceableCredentials(const ReplaceableCredentials&) = delete;
  ReplaceableCredentials& operator=(const ReplaceableCredentials&) = delete;
  ~ReplaceableCredentials() override { grpc_server_credentials_release(made_); }

  void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>& /*processor*/) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), made_);
  }

  /// Called by gRPC with the port's lock held.
  static grpc_ssl_certificate_config_reload_status fetch(void* self, grpc_ssl_server_certificate_config** config) {
    auto& credentials = *static_cast<ReplaceableCredentials*>(self);
    std::shared_ptr<const ServerTls> tls = credentials.tls_->get();
    if (tls == credentials.fetched_) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
    const grpc_ssl_pem_key_cert_pair pair = {tls->identity.key.c_str(), tls->identity.certificates.c_str()};
    // gRPC 1.51 insists on authorities, even where it asks no client for a certificate and uses none.
    const std::string& authorities = tls->client_authorities.empty() ? tls->identity.certificates : tls->client_authorities;
    *config = grpc_ssl_server_certificate_config_create(authorities.c_str(), &pair, 1);
    credentials.fetched_ = std::move(tls);
    return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
  }

  const std::shared_ptr<const Replaceable<ServerTls>> tls_;
  std::shared_ptr<const ServerTls> fetched_;  // null: nothing yet
  grpc_server_credentials* made_;
};

}  // namespace

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

std::shared_ptr<grpc::ServerCredentials> make_credentials(std::shared_ptr<const Replaceable<ServerTls>> tls) {
  if (tls == nullptr) return grpc::InsecureServerCredentials();
  return std::make_shared<ReplaceableCredentials>(std::move(tls));
}

}  // namespace curvecast::server
