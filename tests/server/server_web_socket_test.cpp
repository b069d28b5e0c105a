// The API over WebSockets, as browsers use it.
#include <gmock/gmock.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "server_web_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

TEST_F(ServerWebSocket, CarriesTheWholeApi) {
  WebSocketClient socket = connect_socket();
  ASSERT_TRUE(socket.is_open());
  EXPECT_EQ(socket.subprotocol(), "curvecast.v1");
  const std::string mesh = upload_over(socket, sphere_off(5), 20'000);
  const v1::Session session = create_over(socket, mesh, 1000);
  EXPECT_EQ(session.mesh_id(), mesh);
  const auto listed = socket.call("ListSessions", v1::ListSessionsRequest());
  ASSERT_EQ(listed.code, 0) << listed.error;
  EXPECT_EQ(parsed<v1::ListSessionsResponse>(listed.messages.at(0)).sessions(0).session_id(), session.session_id());
  // The same bytes as through gRPC. A density that the curve was made for: it does not change between the two.
  v1::ResampleRequest request;
  request.set_session_id(session.session_id());
  request.mutable_sample()->set_points(1000);
  const auto answer = socket.call("Resample", request);
  ASSERT_EQ(answer.code, 0) << answer.error;
  Resampled over_web;
  for (const std::string& message : answer.messages) over_web.blocks.push_back(parsed<v1::ResampleResponse>(message));
  EXPECT_EQ(over_web.points(), 1000u);
  EXPECT_EQ(over_web.bytes(), resample(*client(), session.session_id(), request.sample()).bytes());
  v1::CloseSessionRequest close;
  close.set_session_id(session.session_id());
  EXPECT_EQ(socket.call("CloseSession", close).code, 0);
  EXPECT_EQ(socket.call("CloseSession", close).code, grpc::NOT_FOUND);
}

TEST_F(ServerWebSocket, ErrorsHaveDetails) {
  WebSocketClient socket = connect_socket();
  v1::ResampleRequest request;
  request.set_session_id(make_session());
  request.mutable_sample()->set_points(0);
  const auto answer = socket.call("Resample", request);
  EXPECT_EQ(answer.code, grpc::INVALID_ARGUMENT);
  EXPECT_THAT(answer.error, HasSubstr("points"));
  ASSERT_EQ(answer.status.details_size(), 1);
  EXPECT_THAT(answer.status.details(0).type_url(), HasSubstr("BadRequest"));
}

TEST_F(ServerWebSocket, StreamsViews) {
  const std::string session = make_session();
  WebSocketClient socket = connect_socket();
  const std::uint32_t number = socket.next_call();
  const auto open = open_of(session);
  ASSERT_TRUE(socket.send(call_of(number, "StreamViews", &open)));
  v1::CallRequest request;
  request.set_call(number);
  v1::CallResponse response;
  for (std::uint64_t sequence = 1; sequence <= 5; ++sequence) {
    request.set_message(view_message(sequence, view_of(100 * sequence)).SerializeAsString());
    ASSERT_TRUE(socket.send(request));
    ASSERT_TRUE(socket.receive(response));
    ASSERT_TRUE(response.has_message());
    const auto frame = parsed<v1::StreamViewsResponse>(response.message()).frame();
    EXPECT_EQ(frame.sequence(), sequence);
    EXPECT_EQ(frame.held_points(), 100 * sequence);
    request.set_message(ack_of(sequence).SerializeAsString());
    ASSERT_TRUE(socket.send(request));
    // Other calls go on beside it.
    if (sequence == 3) {
      EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
    }
  }
  EXPECT_TRUE(has_line(metrics(), "curvecast_open_streams 1"));
  request.clear_message();
  request.set_half_close(true);
  ASSERT_TRUE(socket.send(request));
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.call(), number);
  ASSERT_TRUE(response.has_status());
  EXPECT_EQ(response.status().code(), 0) << response.status().message();
  wait_for("curvecast_open_streams 0");
}

TEST_F(ServerWebSocket, HalfCloseMayComeWithTheLastMessage) {
  const std::string session = make_session();
  WebSocketClient socket = connect_socket();
  const auto open = open_of(session);
  ASSERT_TRUE(socket.send(call_of(1, "StreamViews", &open)));
  v1::CallRequest request;
  request.set_call(1);
  request.set_message(view_message(7, view_of(300)).SerializeAsString());
  request.set_half_close(true);
  ASSERT_TRUE(socket.send(request));
  v1::CallResponse response;
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(parsed<v1::StreamViewsResponse>(response.message()).frame().held_points(), 300u);
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), 0);
  v1::GetSessionRequest get;
  get.set_session_id(session);
  request = call_of(2, "GetSession", &get);
  request.set_half_close(true);
  ASSERT_TRUE(socket.send(request));
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(parsed<v1::GetSessionResponse>(response.message()).session().session_id(), session);
  ASSERT_TRUE(socket.receive(response));
  EXPECT_TRUE(response.has_status());
}

TEST_F(ServerWebSocket, CancelledCallsEnd) {
  const std::string session = make_session();
  WebSocketClient socket = connect_socket();
  const auto open = open_of(session);
  ASSERT_TRUE(socket.send(call_of(1, "StreamViews", &open)));
  ASSERT_TRUE(socket.send(call_of(2, "UploadMesh")));
  v1::CallRequest request;
  request.set_cancel(true);
  for (const std::uint32_t number : {1u, 2u}) {
    request.set_call(number);
    ASSERT_TRUE(socket.send(request));
    v1::CallResponse response;
    ASSERT_TRUE(socket.receive(response));
    EXPECT_EQ(response.call(), number);
    EXPECT_EQ(response.status().code(), grpc::CANCELLED);
    ASSERT_TRUE(socket.send(request));  // it has gone: that is no error
  }
  wait_for("curvecast_open_streams 0");
  EXPECT_EQ(socket.call("ListSessions", std::vector<std::string>{""}).code, grpc::INVALID_ARGUMENT);  // number 1 again
}

TEST_F(ServerWebSocket, CallsEndWithTheirSocket) {
  const std::string session = make_session();
  {
    WebSocketClient socket = connect_socket();
    const auto open = open_of(session);
    ASSERT_TRUE(socket.send(call_of(1, "StreamViews", &open)));
    v1::CallRequest request;
    request.set_call(1);
    request.set_message(view_message(1, view_of(2000)).SerializeAsString());
    ASSERT_TRUE(socket.send(request));
    ASSERT_TRUE(socket.send(call_of(2, "UploadMesh")));
    wait_for("curvecast_open_streams 1");
  }
  wait_for("curvecast_open_streams 0");
  EXPECT_EQ(connect_socket().call("ListSessions", v1::ListSessionsRequest()).code, 0);
}

TEST_F(ServerWebSocket, AnUploadThatFailsIsToldAtOnce) {
  WebSocketClient socket = connect_socket();
  v1::UploadMeshRequest request;
  request.set_chunk("no header");
  const auto answer = socket.call("UploadMesh", {request.SerializeAsString(), request.SerializeAsString()});
  EXPECT_EQ(answer.code, grpc::INVALID_ARGUMENT);
  EXPECT_THAT(answer.error, HasSubstr("header"));
  // Without half-close too, and the socket goes on.
  ASSERT_TRUE(socket.send(call_of(socket.next_call(), "UploadMesh", &request)));
  v1::CallResponse response;
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
}

TEST_F(ServerWebSocket, RefusesWhatIsNoCall) {
  WebSocketClient socket = connect_socket();
  const auto unknown = socket.call("Nonsense", std::vector<std::string>{});
  EXPECT_EQ(unknown.code, grpc::UNIMPLEMENTED);
  EXPECT_THAT(unknown.error, HasSubstr("Nonsense"));
  v1::CallResponse response;
  ASSERT_TRUE(socket.send(call_of(50, "UploadMesh")));
  ASSERT_TRUE(socket.send(call_of(50, "UploadMesh")));
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(response.status().message(), HasSubstr("grow"));
  v1::CallRequest stray;
  stray.set_call(1234);
  stray.set_message("for nobody");
  ASSERT_TRUE(socket.send(stray));
  // A message that the method does not know.
  const auto bad = socket.call("ListSessions", std::vector<std::string>{"\xff\xff"});
  EXPECT_NE(bad.code, 0);
  const std::string garbage = "\x08\xff";
  for (const bool is_binary : {true, false}) {
    WebSocketClient other = connect_socket();
    ASSERT_TRUE(other.send(garbage, is_binary));
    EXPECT_FALSE(other.receive(response));
    EXPECT_EQ(other.close_code(), 1007);
  }
  WebSocketClient bulky = connect_socket();
  bulky.send(std::string(3 << 20, 'x'));
  EXPECT_FALSE(bulky.receive(response));
}

TEST_F(ServerWebSocket, SurvivesGarbageBelowTheMessages) {
  std::mt19937 random(7);
  for (int i = 0; i < 50; ++i) {
    HttpClient client(server_->http_port());
    client.send(
        "GET /v1/socket HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: curvecast.v1\r\n\r\n");
    ASSERT_EQ(client.receive().status, 101);
    std::string bytes(1 + random() % 300, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    if (i % 2 == 0) bytes.insert(0, "\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff");  // a frame of nearly 2^63 bytes
    client.send(bytes);
  }
  EXPECT_EQ(connect_socket().call("ListSessions", v1::ListSessionsRequest()).code, 0);
}

TEST_F(ServerWebSocket, ABadMessageEndsItsStreamOnly) {
  WebSocketClient socket = connect_socket();
  v1::CallRequest request = call_of(1, "StreamViews");
  request.set_message("\xff\xff");
  ASSERT_TRUE(socket.send(request));
  v1::CallResponse response;
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::INVALID_ARGUMENT);
  const auto open = open_of("nonsense");
  ASSERT_TRUE(socket.send(call_of(2, "StreamViews", &open)));
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::NOT_FOUND);
}

TEST_F(ServerWebSocket, BoundsTheCallsOfASocket) {
  WebSocketClient socket = connect_socket();
  for (std::uint32_t i = 1; i <= 65; ++i) ASSERT_TRUE(socket.send(call_of(i, "StreamViews")));
  v1::CallResponse response;
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.call(), 65u);
  EXPECT_EQ(response.status().code(), grpc::RESOURCE_EXHAUSTED);
}

TEST_F(ServerWebSocket, LetsOnlyItsOwnPagesConnect) {
  const std::string host = "127.0.0.1:" + std::to_string(server_->http_port());
  EXPECT_TRUE(connect_socket({.origin = "http://" + host}).is_open());
  EXPECT_TRUE(connect_socket({.origin = "http://localhost:80", .host = "localhost:80"}).is_open());
  EXPECT_EQ(connect_socket({.origin = "http://example.org"}).http_status(), 403);
  EXPECT_EQ(connect_socket({.origin = "null"}).http_status(), 403);
  // A name that somebody lets point to the loopback.
  EXPECT_EQ(connect_socket({.origin = "http://evil.example", .host = "evil.example"}).http_status(), 403);
  EXPECT_EQ(connect_socket({.subprotocols = "other"}).http_status(), 400);
  EXPECT_EQ(connect_socket({.subprotocols = ""}).http_status(), 400);
  EXPECT_EQ(HttpClient(server_->http_port()).get("/v1/socket").status, 426);
  start({.http = "127.0.0.1:0", .web_origins = {"https://example.org"}});
  EXPECT_TRUE(connect_socket({.origin = "https://example.org"}).is_open());
  EXPECT_EQ(connect_socket({.origin = "http://example.org"}).http_status(), 403);
}

TEST_F(ServerWebSocket, WantsATokenWhereThereAreTokens) {
  const std::string path = ::testing::TempDir() + "web_tokens";
  std::ofstream(path) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";  // "secret"
  start({.tokens = path, .http = "127.0.0.1:0"});
  v1::CallResponse response;
  for (const char* offer : {"curvecast.v1", "curvecast.v1, curvecast.bearer.d3Jvbmc"}) {
    WebSocketClient refused = connect_socket({.subprotocols = offer});
    EXPECT_FALSE(refused.receive(response));
    EXPECT_EQ(refused.close_code(), 1008);
    EXPECT_THAT(refused.close_reason(), HasSubstr("token"));
  }
  WebSocketClient socket = connect_socket({.subprotocols = "curvecast.v1, curvecast.bearer.c2VjcmV0"});
  EXPECT_EQ(socket.subprotocol(), "curvecast.v1");
  EXPECT_EQ(socket.call("ListSessions", v1::ListSessionsRequest()).code, 0);
  const auto open = open_of("nonsense");
  ASSERT_TRUE(socket.send(call_of(socket.next_call(), "StreamViews", &open)));
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::NOT_FOUND);  // not UNAUTHENTICATED
}

TEST_F(ServerWebSocket, BoundsItsSockets) {
  start({.max_streams_of_client = 2, .http = "127.0.0.1:0"});
  WebSocketClient first = connect_socket();
  {
    WebSocketClient second = connect_socket();
    EXPECT_EQ(connect_socket().http_status(), 429);
  }
  EXPECT_EQ(first.call("ListSessions", v1::ListSessionsRequest()).code, 0);
  EXPECT_TRUE(eventually([&] { return connect_socket().is_open(); }));
}

TEST_F(ServerWebSocket, EndsWithTheServer) {
  const std::string session = make_session();
  WebSocketClient socket = connect_socket();
  const auto open = open_of(session);
  ASSERT_TRUE(socket.send(call_of(1, "StreamViews", &open)));
  wait_for("curvecast_open_streams 1");
  server_->shutdown(std::chrono::seconds(1));
  v1::CallResponse response;
  ASSERT_TRUE(socket.receive(response));
  EXPECT_EQ(response.status().code(), grpc::UNAVAILABLE);
  EXPECT_FALSE(socket.receive(response));
  EXPECT_EQ(socket.close_code(), 1001);
  EXPECT_EQ(connect_socket().http_status(), 503);
  WebSocketClient idle = connect_socket();
  server_.reset();
  EXPECT_FALSE(idle.receive(response));
}

TEST_F(ServerWebSocket, ServesFiles) {
  static constexpr WebFile kFiles[] = {{"/index.html", "text/html; charset=utf-8", "packed", false, "'sha256-abc'"},
                                       {"/assets/a-1.js", "text/javascript; charset=utf-8", "script", true}};
  start({.http = "127.0.0.1:0", .pages = kFiles});
  HttpClient browser(server_->http_port());
  for (const char* path : {"/", "/index.html", "/?session=1"}) {
    const auto page = browser.get(path);
    EXPECT_EQ(page.status, 200) << path;
    EXPECT_EQ(page.body, "packed");
    EXPECT_THAT(page.header, HasSubstr("Content-Encoding: gzip\r\n"));
    EXPECT_THAT(page.header, HasSubstr("Cache-Control: no-cache\r\n"));
    EXPECT_THAT(page.header, HasSubstr("script-src 'self' 'wasm-unsafe-eval' 'sha256-abc'; default-src 'self'"));
  }
  EXPECT_THAT(browser.get("/assets/a-1.js").header, HasSubstr("immutable"));
  EXPECT_EQ(browser.get("/assets/none.js").status, 404);
  EXPECT_EQ(browser.get("/healthz").status, 200);
  start({.http = "127.0.0.1:0"});
  const auto none = HttpClient(server_->http_port()).get("/");
  EXPECT_EQ(none.status, 404);
  EXPECT_THAT(none.body, HasSubstr("without the viewer"));
}

TEST_F(ServerWebSocket, AnotherPortWillDoWhereThatIsAllowed) {
  const std::string taken = "127.0.0.1:" + std::to_string(server_->http_port());
  const auto second = Server::start({.log = false, .http = taken, .http_may_move = true});
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_NE((*second)->http_port(), server_->http_port());
  EXPECT_EQ(HttpClient((*second)->http_port()).get("/healthz").status, 200);
}

}  // namespace
}  // namespace curvecast::server
