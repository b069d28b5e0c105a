// Certificates that name their holders, and those that are exchanged while the server goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/server/encrypted_server.h"
#include "tests/server/opened_stream.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerCertificates : public EncryptedServer {
 protected:
  static void SetUpTestSuite() {
    EncryptedServer::SetUpTestSuite();
    files_->issue("ca", "anna", "/CN=client", "URI:spiffe://example.org/anna");
    files_->issue("ca", "bert", "/CN=bert", "");
  }

  ServerOptions options() const {
    return {.http = "127.0.0.1:0",
            .tls_cert = files_->cert("ca-server"),
            .tls_key = files_->key("ca-server"),
            .tls_client_ca = files_->cert("ca")};
  }
  static std::string make_session(Stub& stub) { return create(stub, upload(stub, sphere_off(2)), 500).session.session_id(); }
  static grpc::StatusCode close(Stub& stub, const std::string& session) {
    grpc::ClientContext context;
    set_patience(context);
    v1::CloseSessionRequest request;
    request.set_session_id(session);
    v1::CloseSessionResponse response;
    return stub.CloseSession(&context, request, &response).error_code();
  }
  static int close(WebSocketClient& socket, const std::string& session) {
    v1::CloseSessionRequest request;
    request.set_session_id(session);
    return socket.call("CloseSession", request).code;
  }
  static void copy(const std::string& from, const std::string& to) { files_->write(to, testing::bytes_of(from)); }
  static void use(const std::string& server, const std::string& client_authority) {
    copy(files_->cert(server), "live.pem");
    copy(files_->key(server), "live.key");
    copy(files_->cert(client_authority), "live-ca.pem");
  }
};

TEST_F(ServerCertificates, ASessionIsItsMakersToClose) {
  start(options());
  const auto anna = client_shown_by("anna"), bert = client_shown_by("bert");
  WebSocketClient annas_socket = socket_shown_by("anna"), berts_socket = socket_shown_by("bert");
  ASSERT_TRUE(annas_socket.is_open() && berts_socket.is_open());
  const std::string session = make_session(*anna);
  EXPECT_EQ(close(*bert, session), grpc::PERMISSION_DENIED);
  EXPECT_EQ(close(berts_socket, session), grpc::PERMISSION_DENIED);
  EXPECT_EQ(close(annas_socket, session), grpc::OK);
  EXPECT_EQ(close(*anna, make_session(*anna)), grpc::OK);
  const auto own = stub_of(server_->in_process_channel());
  const std::string of_the_process = make_session(*own);
  EXPECT_EQ(close(*anna, of_the_process), grpc::PERMISSION_DENIED);
  EXPECT_EQ(close(*own, of_the_process), grpc::OK);
}

TEST_F(ServerCertificates, LimitsGoByTheirNames) {
  ServerOptions limited = options();
  limited.max_streams_of_client = 1;
  start(limited);
  const auto anna = client_shown_by("anna"), bert = client_shown_by("bert");
  const std::string session = make_session(*anna);
  OpenedStream first(*anna, session);
  EXPECT_EQ(first.answer().error_code(), grpc::OK);
  OpenedStream second(*anna, session), another(*bert, session);
  EXPECT_EQ(second.answer().error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_EQ(another.answer().error_code(), grpc::OK);
  const WebSocketClient socket = socket_shown_by("anna");
  EXPECT_EQ(socket_shown_by("anna").http_status(), 429);
  EXPECT_TRUE(socket_shown_by("bert").is_open());
}

TEST_F(ServerCertificates, AreExchangedWhileStreamsGoOn) {
  use("ca-server", "ca");
  ServerOptions live = options();
  live.tls_cert = files_->cert("live"), live.tls_key = files_->key("live"), live.tls_client_ca = files_->cert("live-ca");
  start(live);
  files_->issue("other", "others-client", "/CN=carl", "");
  const auto anna = client_shown_by("anna");
  WebSocketClient socket = socket_shown_by("anna");
  OpenedStream stream(*anna, make_session(*anna));
  EXPECT_TRUE(stream.answer(1).ok());

  use("other-server", "other");
  const absl::Status reloaded = server_->reload();
  EXPECT_TRUE(reloaded.ok()) << reloaded;
  const client::TlsFiles others = {
      .ca = files_->cert("other"), .cert = files_->cert("others-client"), .key = files_->key("others-client")};
  const auto expect_the_others = [&] {
    const absl::Status known = call_with(others);
    EXPECT_TRUE(known.ok()) << known;
    EXPECT_EQ(call_with(shown_by("bert")).code(), absl::StatusCode::kUnavailable);
    EXPECT_TRUE(WebSocketClient(server_->http_port(), {.ca = others.ca, .cert = others.cert, .key = others.key}).is_open());
    EXPECT_FALSE(socket_shown_by("bert").is_open());
  };
  expect_the_others();
  stream.acknowledge(1);
  EXPECT_TRUE(stream.answer(2).ok());
  EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);

  for (const char* file : {"live.pem", "live.key", "live-ca.pem"}) {
    use("ca-server", "ca");
    files_->write(file, "nonsense");
    EXPECT_THAT(std::string(server_->reload().message()), HasSubstr(file));
    expect_the_others();
  }
}

}  // namespace
}  // namespace curvecast::server
