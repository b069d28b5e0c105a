// Encrypted connections, and who is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <chrono>
#include <list>
#include <memory>
#include <string>

#include "server/web/web_gateway.h"
#include "tests/server/encrypted_server.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerTls : public EncryptedServer {};

TEST_F(ServerTls, ServesThoseWhoBelieveIt) {
  start({.tls_cert = files_->cert("ca-server"), .tls_key = files_->key("ca-server")});
  const absl::Status status = call_with({.ca = files_->cert("ca")});
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(call_with({.ca = files_->cert("other")}).code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(call(client::tcp_channel(address())).code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(call(server_->in_process_channel()).ok());  // nothing to encrypt
}

TEST_F(ServerTls, RefusesClientsThatNobodyVouchesFor) {
  start({.tls_cert = files_->cert("ca-server"), .tls_key = files_->key("ca-server"), .tls_client_ca = files_->cert("ca")});
  const std::string ca = files_->cert("ca");
  const absl::Status known = call_with({.ca = ca, .cert = files_->cert("ca-client"), .key = files_->key("ca-client")});
  EXPECT_TRUE(known.ok()) << known;
  EXPECT_EQ(call_with({.ca = ca}).code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(call_with({.ca = ca, .cert = files_->cert("other-client"), .key = files_->key("other-client")}).code(),
            absl::StatusCode::kUnavailable);
}

TEST_F(ServerTls, EncryptsTheHttpPortToo) {
  start({.http = "127.0.0.1:0", .tls_cert = files_->cert("ca-server"), .tls_key = files_->key("ca-server")});
  WebSocketClient socket(server_->http_port(), {.ca = files_->cert("ca")});
  ASSERT_TRUE(socket.is_open());
  EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
  EXPECT_FALSE(WebSocketClient(server_->http_port(), {.ca = files_->cert("other")}).is_open());
  EXPECT_FALSE(WebSocketClient(server_->http_port()).is_open());
  HttpClient plain(server_->http_port());
  EXPECT_EQ(plain.get("/healthz").status, 0);
}

TEST_F(ServerTls, WebSocketsWantACertificateOfTheirClientsToo) {
  start({.http = "127.0.0.1:0",
         .tls_cert = files_->cert("ca-server"),
         .tls_key = files_->key("ca-server"),
         .tls_client_ca = files_->cert("ca")});
  const std::string ca = files_->cert("ca");
  const int port = server_->http_port();
  EXPECT_TRUE(WebSocketClient(port, {.ca = ca, .cert = files_->cert("ca-client"), .key = files_->key("ca-client")}).is_open());
  EXPECT_EQ(WebSocketClient(port, {.ca = ca}).http_status(), 403);
  EXPECT_FALSE(
      WebSocketClient(port, {.ca = ca, .cert = files_->cert("other-client"), .key = files_->key("other-client")}).is_open());
}

/// Asks for /healthz, going on with `session` where it is not null, and keeps the session that it then has there. The answer's
/// bytes; empty: there was none. As browsers do, which open several connections to a server.
std::string get_again(SSL_CTX* context, int port, std::unique_ptr<SSL_SESSION, decltype(&SSL_SESSION_free)>& session) {
  const std::unique_ptr<BIO, decltype(&BIO_free_all)> connection(BIO_new_ssl_connect(context), &BIO_free_all);
  SSL* ssl = nullptr;
  BIO_get_ssl(connection.get(), &ssl);
  BIO_set_conn_hostname(connection.get(), ("127.0.0.1:" + std::to_string(port)).c_str());
  if (session != nullptr) {
    EXPECT_EQ(SSL_set_session(ssl, session.get()), 1);
  }
  if (BIO_do_connect(connection.get()) <= 0) return "";
  BIO_puts(connection.get(), "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  char answer[512];
  const int length = BIO_read(connection.get(), answer, sizeof answer);
  EXPECT_EQ(SSL_session_reused(ssl) != 0, session != nullptr);
  session.reset(SSL_get1_session(ssl));
  return {answer, static_cast<std::size_t>(std::max(length, 0))};
}

TEST_F(ServerTls, ConnectionsGoOnWithTheSessionOfTheOneBefore) {
  start({.http = "127.0.0.1:0",
         .tls_cert = files_->cert("ca-server"),
         .tls_key = files_->key("ca-server"),
         .tls_client_ca = files_->cert("ca")});
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
    SSL_CTX_set_max_proto_version(context.get(), version);
    ASSERT_EQ(SSL_CTX_load_verify_locations(context.get(), files_->cert("ca").c_str(), nullptr), 1);
    ASSERT_EQ(SSL_CTX_use_certificate_chain_file(context.get(), files_->cert("ca-client").c_str()), 1);
    ASSERT_EQ(SSL_CTX_use_PrivateKey_file(context.get(), files_->key("ca-client").c_str(), SSL_FILETYPE_PEM), 1);
    std::unique_ptr<SSL_SESSION, decltype(&SSL_SESSION_free)> session(nullptr, &SSL_SESSION_free);
    EXPECT_THAT(get_again(context.get(), server_->http_port(), session), HasSubstr("200 OK")) << version;
    EXPECT_THAT(get_again(context.get(), server_->http_port(), session), HasSubstr("200 OK")) << version;
  }
}

// As if they had said nothing over HTTP. Nobody's handshake takes so long that the time is up.
TEST_F(ServerTls, HandshakesThatSayNothingGiveWay) {
  const auto tls = read_server_tls({.tls_cert = files_->cert("ca-server"), .tls_key = files_->key("ca-server")});
  ASSERT_TRUE(tls.ok()) << tls.status();
  WebRoutes routes;
  routes["/healthz"] = [] { return WebAnswer{.body = "alive\n"}; };
  const auto gateway =
      WebGateway::start({.listen = "127.0.0.1:0", .max_connections = 3, .time_out = std::chrono::hours(1), .tls = *tls}, routes,
                        make_logger(false, false));
  ASSERT_TRUE(gateway.ok()) << gateway.status();
  std::list<HttpClient> silent;
  for (int i = 0; i < 20; ++i) silent.emplace_back((*gateway)->port());
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
  std::unique_ptr<SSL_SESSION, decltype(&SSL_SESSION_free)> session(nullptr, &SSL_SESSION_free);
  EXPECT_THAT(get_again(context.get(), (*gateway)->port(), session), HasSubstr("alive"));
}

TEST_F(ServerTls, SaysWhatIsWrongWithItsFiles) {
  const std::string cert = files_->cert("ca-server"), key = files_->key("ca-server");
  const auto refused = [](const ServerOptions& options) {
    const auto server = Server::start(options);
    EXPECT_FALSE(server.ok());
    return std::string(server.status().message());
  };
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_cert = cert}), HasSubstr("belong together"));
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_key = key}), HasSubstr("belong together"));
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_client_ca = cert}), HasSubstr("tls-cert and tls-key"));
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_cert = "/nonexistent.pem", .tls_key = key}),
              HasSubstr("/nonexistent.pem"));
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_cert = cert, .tls_key = files_->key("other-server")}),
              HasSubstr("does not belong"));
  EXPECT_THAT(refused({.listen = "127.0.0.1:0", .log = false, .tls_cert = cert, .tls_key = key, .tls_client_ca = key}),
              HasSubstr("no certificate"));
}

TEST_F(ServerTls, ClientsAreToldWhatIsWrongWithTheirs) {
  const auto refused = [](const client::TlsFiles& files) {
    return std::string(client::tls_channel("localhost:1", files).status().message());
  };
  EXPECT_THAT(refused({.ca = "/nonexistent.pem"}), HasSubstr("/nonexistent.pem"));
  EXPECT_THAT(refused({.cert = files_->cert("ca-client")}), HasSubstr("belong together"));
  EXPECT_THAT(refused({.cert = files_->cert("ca-client"), .key = files_->key("other-client")}), HasSubstr("does not belong"));
}

}  // namespace
}  // namespace curvecast::server
