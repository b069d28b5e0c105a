// A server whose ports are encrypted, and certificates for it and its clients.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "client/lib/connection.h"
#include "proto/tls/exit_cleanup.h"
#include "server/server.h"
#include "tests/proto/tls/certificate_files.h"
#include "tests/server/server_fixture.h"
#include "tests/server/web/web_socket_client.h"

namespace curvecast::server {

class EncryptedServer : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    tls::skip_cleanup_at_exit();
    files_ = std::make_unique<testing::CertificateFiles>();
  }
  static void TearDownTestSuite() { files_.reset(); }

  void start(ServerOptions options) {
    options.listen = "127.0.0.1:0";
    options.log = false;
    auto server = Server::start(options);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }
  /// Asks the server for its sessions over a channel.
  static absl::Status call(const absl::StatusOr<std::shared_ptr<grpc::Channel>>& channel) {
    if (!channel.ok()) return channel.status();
    const auto connection = client::make_connection(*channel, {.retry = {.attempts = 1}});
    return connection->list_sessions({}, {}).status();
  }
  static std::unique_ptr<Stub> stub_of(const absl::StatusOr<std::shared_ptr<grpc::Channel>>& channel) {
    EXPECT_TRUE(channel.ok()) << channel.status();
    return v1::CurvecastService::NewStub(channel.value());
  }
  std::string address() const { return "localhost:" + std::to_string(server_->port()); }
  /// That speaks to servers of "ca", and shows a certificate of this name.
  static client::TlsFiles shown_by(const std::string& name) {
    return {.ca = files_->cert("ca"), .cert = files_->cert(name), .key = files_->key(name)};
  }
  std::unique_ptr<Stub> client_shown_by(const std::string& name) const {
    return stub_of(client::tls_channel(address(), shown_by(name)));
  }
  WebSocketClient socket_shown_by(const std::string& name) const {
    const client::TlsFiles files = shown_by(name);
    return WebSocketClient(server_->http_port(), {.ca = files.ca, .cert = files.cert, .key = files.key});
  }
  absl::Status call_with(const client::TlsFiles& files) const { return call(client::tls_channel(address(), files)); }

  static inline std::unique_ptr<testing::CertificateFiles> files_;
  std::unique_ptr<Server> server_;
};

}  // namespace curvecast::server
