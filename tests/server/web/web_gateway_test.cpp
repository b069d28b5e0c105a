#include "server/web/web_gateway.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "server/base/log.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Gateway : public ::testing::Test {
 protected:
  void SetUp() override { start({.listen = "127.0.0.1:0"}); }

  void start(const WebGatewayOptions& options) {
    gateway_.reset();
    WebRoutes routes;
    routes["/hello"] = [] { return WebAnswer{.body = "hello\n"}; };
    routes["/busy"] = [] { return WebAnswer{.status = 503, .body = "busy\n"}; };
    routes["/large"] = [] { return WebAnswer{.body = std::string(20 << 20, 'x'), .type = "text/css"}; };
    routes["/throws"] = []() -> WebAnswer { throw std::runtime_error("on purpose"); };
    auto gateway = WebGateway::start(options, std::move(routes), make_logger(false, false));
    ASSERT_TRUE(gateway.ok()) << gateway.status();
    gateway_ = *std::move(gateway);
    ASSERT_GT(gateway_->port(), 0);
  }

  /// To a request of its own connection.
  HttpClient::Response answer_to(const std::string& bytes) const {
    HttpClient client(gateway_->port());
    client.send(bytes);
    return client.receive();
  }

  std::unique_ptr<WebGateway> gateway_;
};

TEST_F(Gateway, AnswersManyRequestsOnOneConnection) {
  HttpClient client(gateway_->port());
  for (int i = 0; i < 100; ++i) {
    const auto response = client.get("/hello");
    ASSERT_EQ(response.status, 200);
    ASSERT_EQ(response.body, "hello\n");
  }
  EXPECT_EQ(client.get("/hello?a=b").body, "hello\n");
  const auto busy = client.get("/busy");
  EXPECT_EQ(busy.status, 503);
  EXPECT_EQ(busy.body, "busy\n");
  const auto large = client.get("/large");
  EXPECT_EQ(large.body.size(), std::size_t{20} << 20);
  EXPECT_THAT(large.header, HasSubstr("text/css"));
  EXPECT_EQ(client.get("/throws").status, 500);
  EXPECT_EQ(client.get("/hello").status, 200);
}

TEST_F(Gateway, HeadTellsTheLengthOnly) {
  HttpClient client(gateway_->port());
  const auto response = client.get("/hello", "HEAD");
  EXPECT_EQ(response.status, 200);
  EXPECT_THAT(response.header, HasSubstr("Content-Length: 6\r\n"));
  EXPECT_EQ(client.get("/hello").body, "hello\n");  // nothing was left over
}

TEST_F(Gateway, KnowsWhatItDoesNotHave) {
  HttpClient client(gateway_->port());
  for (const char* path : {"/", "/hell", "/hello/", "/hello/../hello", "//hello", "*", "/%68ello"}) {
    EXPECT_EQ(client.get(path).status, 404) << path;
  }
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE"}) {
    const auto response = client.get("/hello", method);
    EXPECT_EQ(response.status, 405) << method;
    EXPECT_THAT(response.header, HasSubstr("Allow: GET, HEAD\r\n"));
  }
}

TEST_F(Gateway, AnswersPipelinedRequestsInOrder) {
  HttpClient client(gateway_->port());
  client.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\nGET /busy HTTP/1.1\r\nHost: a\r\n\r\nGET /none HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive().status, 200);
  EXPECT_EQ(client.receive().status, 503);
  EXPECT_EQ(client.receive().status, 404);
}

TEST_F(Gateway, ClosesWhereTheClientWantsIt) {
  for (const char* request : {"GET /hello HTTP/1.0\r\n\r\n", "GET /hello HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"}) {
    HttpClient client(gateway_->port());
    client.send(request);
    EXPECT_EQ(client.receive().body, "hello\n");
    EXPECT_TRUE(client.is_closed());
  }
}

TEST_F(Gateway, TakesNoBody) {
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\n12345").status, 413);
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n5\r\n12345\r\n0\r\n\r\n").status, 413);
  HttpClient client(gateway_->port());
  client.send("POST /hello HTTP/1.1\r\nHost: a\r\nContent-Length: 99999999\r\n\r\n");
  EXPECT_EQ(client.receive().status, 405);
  EXPECT_TRUE(client.is_closed());
}

TEST_F(Gateway, SurvivesGarbage) {
  EXPECT_EQ(answer_to("nonsense\r\n\r\n").status, 400);
  EXPECT_EQ(answer_to(std::string("\0\xff\x16\x03\x01 \r\n\r\n", 10)).status, 400);
  EXPECT_EQ(answer_to("GET /hello HTTP/9.9\r\n\r\n").status, 400);
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nContent-Length: 99999999999999999999999\r\n\r\n").status, 400);
  EXPECT_EQ(answer_to(absl::StrCat("GET /hello HTTP/1.1\r\nA: ", std::string(9000, 'a'), "\r\n\r\n")).status, 431);
  EXPECT_EQ(answer_to(absl::StrCat("GET /", std::string(7000, 'a'), " HTTP/1.1\r\nHost: a\r\n\r\n")).status, 404);
  EXPECT_EQ(answer_to("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n").status, 400);
  for (const char* part : {"", "G", "GET /hello HTTP/1.1\r\nHost"}) {
    HttpClient client(gateway_->port());
    client.send(part);  // and goes
  }
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n").body, "hello\n");
}

TEST_F(Gateway, ClosesConnectionsThatAreTooSlow) {
  start({.listen = "127.0.0.1:0", .time_out = std::chrono::milliseconds(50)});
  HttpClient silent(gateway_->port()), half(gateway_->port()), idle(gateway_->port()), dripping(gateway_->port());
  half.send("GET /hello HTTP/1.1\r\n");
  EXPECT_EQ(idle.get("/hello").status, 200);
  while (dripping.send("A")) {  // each letter in time, the whole not
  }
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(half.is_closed());
  EXPECT_TRUE(idle.is_closed());
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n").status, 200);
}

TEST_F(Gateway, ClosesConnectionsThatTakeNoAnswer) {
  start({.listen = "127.0.0.1:0", .max_connections = 1, .time_out = std::chrono::milliseconds(50)});
  HttpClient deaf(gateway_->port());
  deaf.send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n").status, 200);  // when the other one has gone
}

TEST_F(Gateway, TheIdlestConnectionGivesWayToOneMore) {
  start({.listen = "127.0.0.1:0", .max_connections = 3});
  std::vector<std::unique_ptr<HttpClient>> clients;
  for (int i = 0; i < 3; ++i) {
    clients.push_back(std::make_unique<HttpClient>(gateway_->port()));
    EXPECT_EQ(clients.back()->get("/hello").status, 200);
  }
  EXPECT_EQ(clients[0]->get("/hello").status, 200);
  EXPECT_EQ(HttpClient(gateway_->port()).get("/hello").status, 200);
  EXPECT_TRUE(clients[1]->is_closed());
  EXPECT_EQ(clients[0]->get("/hello").status, 200);
  EXPECT_EQ(clients[2]->get("/hello").status, 200);
}

/// Of a page of the server's own.
std::string page_asks(const std::string& path, const std::string& more = "", const std::string& method = "GET") {
  return absl::StrCat(method, " ", path, " HTTP/1.1\r\nHost: localhost\r\nCurvecast-Page: 1\r\n", more, "\r\n");
}

class LateGateway : public Gateway {
 protected:
  void SetUp() override { start_late(std::chrono::seconds(10)); }

  void start_late(std::chrono::milliseconds time_out) {
    WebSocketOptions sockets{.path = "/socket"};
    sockets.late_routes["/later"] = [this](const WebQuestion& question, std::function<void(WebAnswer)> answer) {
      asked_.push_back(question);
      const bool is_answered = question.query != "never";
      if (!is_answered) kept_.push_back(answer);
      ++count_;
      if (is_answered) answer({.body = "here\n"});
    };
    start({.listen = "127.0.0.1:0", .time_out = time_out, .sockets = sockets});
  }
  void TearDown() override { gateway_.reset(); }

  /// All questions, once there are so many.
  const std::vector<WebQuestion>& questions(std::size_t count) const {
    while (count_ < count) std::this_thread::yield();
    return asked_;
  }

  std::atomic<std::size_t> count_ = 0;  // of the following; no other comes while they are read
  std::vector<WebQuestion> asked_;
  std::vector<std::function<void(WebAnswer)>> kept_;
};

TEST_F(LateGateway, AnswersLaterOnTheSameConnection) {
  HttpClient client(gateway_->port());
  for (int i = 0; i < 3; ++i) {
    client.send(page_asks("/later?a=1&b"));
    EXPECT_EQ(client.receive().body, "here\n");
  }
  EXPECT_EQ(client.get("/hello").body, "hello\n");
  client.send(page_asks("/later", "", "HEAD"));
  EXPECT_EQ(client.receive(false).status, 200);
  client.send(page_asks("/later", "", "POST"));
  EXPECT_EQ(client.receive().status, 405);
  const std::vector<WebQuestion>& asked = questions(4);
  ASSERT_EQ(asked.size(), 4u);
  EXPECT_EQ(asked[0].query, "a=1&b");
  EXPECT_EQ(asked[3].query, "");
  EXPECT_THAT(asked[0].peer.address, HasSubstr("127.0.0.1"));
}

TEST_F(LateGateway, PassesTokensOn) {
  EXPECT_EQ(answer_to(page_asks("/later", "Authorization: Bearer abc\r\n")).status, 200);
  EXPECT_EQ(answer_to(page_asks("/later", "Authorization: Basic abc\r\n")).status, 200);
  EXPECT_EQ(answer_to(page_asks("/later", "Authorization: Bearer \xff\r\n")).status, 200);
  const std::vector<WebQuestion>& asked = questions(3);
  EXPECT_EQ(asked.at(0).peer.authorization, "Bearer abc");
  EXPECT_EQ(asked.at(1).peer.authorization, "");
  EXPECT_EQ(asked.at(2).peer.authorization, "");
}

TEST_F(LateGateway, IsForItsOwnPages) {
  EXPECT_EQ(answer_to("GET /later HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 403);
  EXPECT_EQ(answer_to("GET /later HTTP/1.1\r\nHost: evil.example\r\nCurvecast-Page: 1\r\n\r\n").status, 403);
  EXPECT_EQ(answer_to("GET /later HTTP/1.1\r\nCurvecast-Page: 1\r\n\r\n").status, 403);
  EXPECT_THAT(questions(0), IsEmpty());
}

TEST_F(LateGateway, WaitsOnlySoLong) {
  start_late(std::chrono::milliseconds(50));
  HttpClient client(gateway_->port());
  client.send(page_asks("/later?never"));
  EXPECT_EQ(client.receive().status, 503);
  kept_.at(0)({.body = "too late\n"});
  EXPECT_EQ(client.get("/hello").body, "hello\n");
}

TEST_F(LateGateway, EndsWhileAnswersAreMissing) {
  HttpClient waiting(gateway_->port());
  waiting.send(page_asks("/later?never"));
  questions(1);
  gateway_.reset();
  EXPECT_TRUE(waiting.is_closed());
  kept_.at(0)({.body = "for nobody\n"});
}

TEST_F(Gateway, EndsWithOpenConnections) {
  HttpClient idle(gateway_->port()), half(gateway_->port());
  EXPECT_EQ(idle.get("/hello").status, 200);
  half.send("GET /hello");
  gateway_.reset();
  EXPECT_TRUE(idle.is_closed());
  EXPECT_TRUE(half.is_closed());
}

TEST_F(Gateway, SaysWhyItCannotListen) {
  const std::string taken = absl::StrCat("127.0.0.1:", gateway_->port());
  const auto second = WebGateway::start({.listen = taken}, {}, make_logger(false, false));
  EXPECT_EQ(second.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(second.status().message(), HasSubstr(taken));
  EXPECT_THAT(second.status().message(), HasSubstr("in use"));
  const auto malformed = WebGateway::start({.listen = "nonsense"}, {}, make_logger(false, false));
  EXPECT_EQ(malformed.status().code(), absl::StatusCode::kInvalidArgument);
  const auto foreign = WebGateway::start({.listen = "192.0.2.1:0"}, {}, make_logger(false, false));
  EXPECT_EQ(foreign.status().code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace curvecast::server
