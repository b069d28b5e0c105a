// Tokens that are taken back while the server goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/server/opened_stream.h"
#include "tests/server/server_web_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

// For each: printf %s "anna's" | sha256sum
constexpr char kAnna[] = "anna 8f68ce373d4607a65f1b1ce5c42eef43dcc492fdf17a5bb36bdca6d656ca21da";
constexpr char kBert[] = "bert a1eeb16073426839c5dfabc8fc71999ccbcee5ee0ce82ca9588a528582c4bb17";
constexpr char kAnnasToken[] = "curvecast.v1, curvecast.bearer.YW5uYSdz",
               kBertsToken[] = "curvecast.v1, curvecast.bearer.YmVydCdz";

class ServerReload : public ServerWebSocket {
 protected:
  void SetUp() override {
    write(std::string(kAnna) + "\n" + kBert + "\n");
    start({.tokens = file_, .max_streams_of_client = 3, .max_curve_vertices = 0, .http = "127.0.0.1:0"});
    anna_ = client_with("anna's"), bert_ = client_with("bert's");
    session_ = create(*bert_, upload(*bert_, sphere_off(2)), 500).session.session_id();
  }
  void write(const std::string& tokens) const { testing::write_file(file_, tokens); }
  /// What a call ends with that asks for what is in memory.
  static grpc::StatusCode call(Stub& stub) {
    grpc::ClientContext context;
    set_patience(context);
    v1::ListSessionsResponse response;
    return stub.ListSessions(&context, {}, &response).error_code();
  }
  /// Begins a stream of views over a socket, and waits for a frame.
  void begin_stream(WebSocketClient& socket) const {
    const std::uint32_t number = socket.next_call();
    const auto open = open_of(session_);
    const auto view = view_message(1, view_of(10));
    ASSERT_TRUE(socket.send(call_of(number, "StreamViews", &open)));
    ASSERT_TRUE(socket.send(call_of(number, "", &view)));
    v1::CallResponse response;
    ASSERT_TRUE(socket.receive(response));
    ASSERT_TRUE(response.has_message()) << response.status().message();
    EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);  // now the frame has left
  }
  /// Reads until the stream ends.
  static grpc::Status end_of(OpenedStream& stream) {
    v1::StreamViewsResponse response;
    while (stream.stream->Read(&response)) {
    }
    return stream.stream->Finish();
  }

  const testing::TemporaryFolder folder_;
  const std::string file_ = folder_ / "tokens";
  std::unique_ptr<Stub> anna_, bert_;
  std::string session_;
};

TEST_F(ServerReload, WhoHasLostHisTokenIsShownOut) {
  OpenedStream annas(*anna_, session_), berts(*bert_, session_);
  EXPECT_TRUE(annas.answer().ok());
  EXPECT_TRUE(berts.answer().ok());
  WebSocketClient annas_socket = connect_socket({.subprotocols = kAnnasToken});
  WebSocketClient berts_socket = connect_socket({.subprotocols = kBertsToken});
  begin_stream(annas_socket), begin_stream(berts_socket);
  WebSocketClient idle = connect_socket({.subprotocols = kAnnasToken});
  ASSERT_TRUE(idle.is_open());

  write(kBert);
  EXPECT_TRUE(server_->reload().ok());
  EXPECT_EQ(call(*anna_), grpc::UNAUTHENTICATED);
  EXPECT_EQ(OpenedStream(*anna_, session_).answer().error_code(), grpc::UNAUTHENTICATED);
  EXPECT_EQ(end_of(annas).error_code(), grpc::UNAUTHENTICATED);
  v1::CallResponse response;
  while (annas_socket.receive(response) && !response.has_status()) {  // frames
  }
  EXPECT_EQ(response.status().code(), grpc::UNAUTHENTICATED);
  for (WebSocketClient* socket : {&annas_socket, &idle}) {
    EXPECT_FALSE(socket->receive(response));
    EXPECT_EQ(socket->close_code(), 1008);
    EXPECT_THAT(socket->close_reason(), HasSubstr("token"));
  }

  EXPECT_EQ(call(*bert_), grpc::OK);
  berts.acknowledge(1);
  EXPECT_TRUE(berts.answer(2).ok());
  EXPECT_EQ(berts_socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
}

TEST_F(ServerReload, AFileThatIsWrongChangesNothing) {
  for (const char* text : {"anna", "# nobody\n"}) {
    write(text);
    const absl::Status status = server_->reload();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(file_));
    EXPECT_EQ(call(*anna_), grpc::OK);
  }
  std::filesystem::remove(file_);
  EXPECT_THAT(std::string(server_->reload().message()), HasSubstr(file_));
  EXPECT_EQ(call(*anna_), grpc::OK);
  write(kBert);
  EXPECT_TRUE(server_->reload().ok());
  EXPECT_EQ(call(*anna_), grpc::UNAUTHENTICATED);
}

TEST_F(ServerReload, StreamsEndWhenTheirTokenExpires) {
  // However slow this is, there is a time that is long enough for a stream to begin.
  for (int seconds = 2;; seconds *= 2) {
    const auto end = std::chrono::system_clock::now() + std::chrono::seconds(seconds);
    write(std::string(kAnna) + " " + std::to_string(std::chrono::system_clock::to_time_t(end)) + "\n");
    ASSERT_TRUE(server_->reload().ok());
    OpenedStream stream(*anna_, session_);
    if (!stream.answer().ok()) continue;
    const grpc::Status status = end_of(stream);
    EXPECT_EQ(status.error_code(), grpc::UNAUTHENTICATED);
    EXPECT_THAT(status.error_message(), HasSubstr("expired"));
    return;
  }
}

TEST_F(ServerReload, WebSocketsAreCountedByToken) {
  std::vector<std::unique_ptr<WebSocketClient>> open;
  const auto connect = [&](const char* token) {
    open.push_back(std::make_unique<WebSocketClient>(server_->http_port(), WebSocketClientOptions{.subprotocols = token}));
    return open.back()->http_status();
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(connect(kAnnasToken), 101);
  EXPECT_EQ(connect(kAnnasToken), 429);
  EXPECT_EQ(connect(kBertsToken), 101) << "from the same address";
}

TEST_F(ServerReload, ThereMayBeNothingToRead) {
  start({});
  EXPECT_TRUE(server_->reload().ok());
}

}  // namespace
}  // namespace curvecast::server
