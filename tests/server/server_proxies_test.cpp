// Clients that come by a proxy, over TCP: the tests are the proxies.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/server/net/proxy_relay.h"
#include "tests/server/opened_stream.h"
#include "tests/server/server_web_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

constexpr char kHeader[] = "x-forwarded-for";

class ServerProxies : public ServerWebSocket {
 protected:
  void SetUp() override {}
  /// A caller may have one stream, and one WebSocket.
  void start_with(const std::vector<std::string>& proxies) {
    start({.trusted_proxies = proxies, .max_streams_of_client = 1, .http = "127.0.0.1:0"});
    session_ = make_session();
  }
  /// Whether the client of these hops may have one more stream of views, which it keeps.
  bool may_stream(const std::string& hops) { return may_stream(client_sending(kHeader, hops)); }
  /// As well, by a proxy that sends such a header of its own.
  bool may_stream_through(const std::string& header) {
    relays_.push_back(std::make_unique<ProxyRelay>(server_->port(), header));
    const std::string relay = absl::StrCat("127.0.0.1:", relays_.back()->port());
    return may_stream(v1::CurvecastService::NewStub(grpc::CreateChannel(relay, grpc::InsecureChannelCredentials())));
  }
  bool may_stream(std::unique_ptr<Stub> stub) {
    stubs_.push_back(std::move(stub));
    streams_.push_back(std::make_unique<OpenedStream>(*stubs_.back(), session_));
    const grpc::Status status = streams_.back()->answer();
    EXPECT_TRUE(status.ok() || status.error_code() == grpc::RESOURCE_EXHAUSTED) << status.error_message();
    return status.ok();
  }
  bool may_connect_through(const std::string& header) {
    relays_.push_back(std::make_unique<ProxyRelay>(server_->http_port(), header));
    return may_connect("", relays_.back()->port());
  }
  bool may_connect(const std::string& hops) { return may_connect(hops, server_->http_port()); }
  bool may_connect(const std::string& hops, int port) {
    sockets_.push_back(std::make_unique<WebSocketClient>(port, WebSocketClientOptions{.forwarded_for = hops}));
    if (sockets_.back()->is_open()) return true;
    EXPECT_EQ(sockets_.back()->http_status(), 429);
    return false;
  }
  /// As may_stream(), over the newest WebSocket.
  bool may_stream_over_socket() {
    WebSocketClient& socket = *sockets_.back();
    const std::uint32_t call = socket.next_call();
    const auto open = open_of(session_);
    const auto view = view_message(1, view_of(10));
    EXPECT_TRUE(socket.send(call_of(call, "StreamViews", &open)));
    EXPECT_TRUE(socket.send(call_of(call, "", &view)));
    v1::CallResponse response;
    EXPECT_TRUE(socket.receive(response));
    if (!response.has_status()) return true;
    EXPECT_EQ(response.status().code(), grpc::RESOURCE_EXHAUSTED) << response.status().message();
    return false;
  }

  std::string session_;
  std::vector<std::unique_ptr<ProxyRelay>> relays_;
  std::vector<std::unique_ptr<Stub>> stubs_;
  std::vector<std::unique_ptr<OpenedStream>> streams_;
  std::vector<std::unique_ptr<WebSocketClient>> sockets_;
};

TEST_F(ServerProxies, EachClientHasLimitsOfItsOwn) {
  start_with({"127.0.0.0/8"});
  EXPECT_TRUE(may_stream("198.51.100.1"));
  EXPECT_TRUE(may_stream("198.51.100.2"));
  EXPECT_FALSE(may_stream("198.51.100.1"));
  EXPECT_FALSE(may_stream("203.0.113.9, 198.51.100.1")) << "what it wrote itself does not count";
  EXPECT_FALSE(may_stream("203.0.113.9, 198.51.100.1, 127.0.0.2"));
  EXPECT_TRUE(may_stream("nonsense")) << "the proxy itself";
  EXPECT_FALSE(may_stream("203.0.113.9, nonsense"));
  EXPECT_TRUE(may_connect("198.51.100.1"));
  EXPECT_FALSE(may_stream_over_socket()) << "it is the same client";
  EXPECT_TRUE(may_connect("198.51.100.3"));
  EXPECT_TRUE(may_stream_over_socket());
  EXPECT_FALSE(may_connect("203.0.113.9, 198.51.100.3"));
}

TEST_F(ServerProxies, ThatDoNotLookIntoConnectionsSayWhoseTheyAre) {
  start_with({"127.0.0.0/8"});
  const std::string text = "PROXY TCP4 198.51.100.1 10.0.0.2 4711 443\r\n";
  const std::string binary("\r\n\r\n\0\r\nQUIT\n\x21\x11\0\x0c\xc6\x33\x64\x02\x0a\0\0\x02\x12\x67\x01\xbb", 28);  // 198.51.100.2
  EXPECT_TRUE(may_stream_through(text));
  EXPECT_FALSE(may_stream("198.51.100.1")) << "it is the same client";
  EXPECT_TRUE(may_stream_through(binary));
  EXPECT_FALSE(may_stream_through(binary));
  EXPECT_TRUE(may_stream_through("")) << "the proxy itself, which says nothing";
  EXPECT_TRUE(may_connect_through(text));
  EXPECT_FALSE(may_stream_over_socket());
  EXPECT_FALSE(may_connect("198.51.100.1"));
  EXPECT_TRUE(may_connect_through(binary));
  EXPECT_FALSE(may_connect_through(binary));
}

TEST_F(ServerProxies, WhatComesByOneMayComeByAnother) {
  // The client of the first is the second, which looks into what it sends on.
  start_with({"127.0.0.0/8", "10.0.0.0/8"});
  const ProxyRelay first(server_->http_port(), "PROXY TCP4 10.0.0.9 10.0.0.2 4711 443\r\n");
  EXPECT_TRUE(may_connect("198.51.100.1", first.port()));
  EXPECT_TRUE(may_connect("198.51.100.2", first.port()));
  EXPECT_FALSE(may_connect("203.0.113.9, 198.51.100.1", first.port()));
}

TEST_F(ServerProxies, NobodyElseIsBelieved) {
  start_with({"192.0.2.0/24"});
  EXPECT_TRUE(may_stream("198.51.100.1"));
  EXPECT_FALSE(may_stream("198.51.100.2"));
  EXPECT_TRUE(may_connect("198.51.100.1"));
  EXPECT_FALSE(may_connect("198.51.100.2"));
}

TEST(Proxies, OfNoNetworkStopTheServer) {
  const auto server = Server::start({.trusted_proxies = {"proxy.example.org"}, .log = false});
  EXPECT_TRUE(absl::IsInvalidArgument(server.status()));
  EXPECT_THAT(std::string(server.status().message()), ::testing::HasSubstr("proxy.example.org"));
}

}  // namespace
}  // namespace curvecast::server
