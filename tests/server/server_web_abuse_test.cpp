// What must not hurt a server, however it comes over its HTTP port.
#include <gmock/gmock.h>

#include <fstream>
#include <list>

#include "server_web_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerWebAbuse : public ServerWebSocket {};

// gRPC ends the process where it is given metadata that is not printable ASCII.
TEST_F(ServerWebAbuse, TokensMayHoldAnyBytes) {
  for (const char* token : {"Cg", "w6Q", "AA", "c2VjcmV0Cg", "", "!"}) {  // "\n", "\u00e4", "\0", "secret\n", nothing, no base64
    WebSocketClient socket = connect_socket({.subprotocols = std::string("curvecast.v1, curvecast.bearer.") + token});
    EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0) << token;
  }
}

TEST_F(ServerWebAbuse, ATokenIsTakenWithBlanksAroundIt) {
  const std::string path = ::testing::TempDir() + "abused_tokens";
  std::ofstream(path) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";  // "secret"
  start({.tokens = path, .http = "127.0.0.1:0"});
  WebSocketClient socket = connect_socket({.subprotocols = "curvecast.v1, curvecast.bearer.c2VjcmV0Cg"});  // "secret\n"
  EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
  WebSocketClient refused = connect_socket({.subprotocols = "curvecast.v1, curvecast.bearer.w6Q"});
  v1::CallResponse response;
  EXPECT_FALSE(refused.receive(response));
  EXPECT_THAT(refused.close_reason(), HasSubstr("token"));
}

TEST_F(ServerWebAbuse, AStreamThatWasSlowedDownLeavesNothingBehind) {
  start({.max_view_rate = 20, .http = "127.0.0.1:0"});
  const std::string session = make_session();
  {
    WebSocketClient socket = connect_socket();
    const auto open = open_of(session);
    ASSERT_TRUE(socket.send(call_of(1, "StreamViews", &open)));
    wait_for("curvecast_open_streams 1");
    for (std::uint64_t i = 1; i <= 60; ++i) {
      v1::CallRequest request;
      request.set_call(1);
      request.set_message(view_message(i, view_of(10)).SerializeAsString());
      ASSERT_TRUE(socket.send(request));
    }
    v1::CallResponse response;
    ASSERT_TRUE(socket.receive(response));
    // A second's worth is taken at once. Each message after it ends a pause and begins another: the connection goes amidst one.
    ASSERT_TRUE(eventually([&] { return metric("curvecast_views_received_total") >= 22; }));
  }
  wait_for("curvecast_open_streams 0");
  server_.reset();  // ends
}

TEST_F(ServerWebAbuse, IdleConnectionsGiveWayToNewOnes) {
  std::list<HttpClient> idle;
  for (int i = 0; i < 200; ++i) EXPECT_EQ(idle.emplace_back(server_->http_port()).get("/healthz").status, 200) << i;
  std::list<HttpClient> silent;
  for (int i = 0; i < 200; ++i) silent.emplace_back(server_->http_port());
  EXPECT_EQ(HttpClient(server_->http_port()).get("/healthz").status, 200);
  EXPECT_TRUE(idle.front().is_closed());
}

}  // namespace
}  // namespace curvecast::server
