#include "server/web/web_calls.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "curvecast/v1/web_socket.pb.h"
#include "server/base/log.h"
#include "server/server.h"

namespace curvecast::server {
namespace {

/// One whose client takes nothing until it is told to.
class HeldSocket final : public WebSocket {
 public:
  void send(std::string message, std::function<void(bool)> on_sent) override {
    v1::CallResponse& response = sent.emplace_back();
    EXPECT_TRUE(response.ParseFromString(message));
    waiting_.push_back(std::move(on_sent));
  }
  void read_on() override { ++reads; }
  void close(WebSocketClose /*code*/, std::string /*reason*/) override { is_closed = true; }

  void drop() override {}

  void let_go() {
    for (const auto& on_sent : std::exchange(waiting_, {})) on_sent(true);
  }

  std::vector<v1::CallResponse> sent;
  int reads = 0;
  bool is_closed = false;

 private:
  std::vector<std::function<void(bool)>> waiting_;
};

class WebCallsTest : public ::testing::Test {
 protected:
  void receive(std::uint32_t call, const std::string& method) const {
    v1::CallRequest request;
    request.set_call(call);
    request.set_method(method);
    conversation_->receive(request.SerializeAsString());
  }

  const std::shared_ptr<spdlog::logger> log_ = make_logger(false, false);
  Engine engine_{ServerOptions{.threads = 1}, log_, nullptr};
  const std::shared_ptr<HeldSocket> socket_ = std::make_shared<HeldSocket>();
  const std::unique_ptr<WebConversation> conversation_ =
      web_calls(engine_, grpc::CreateChannel("127.0.0.1:1", grpc::InsecureChannelCredentials()))(
          socket_, {{.address = "ipv4:1.2.3.4:5"}, Caller{.name = "ipv4:1.2.3.4", .address = "ipv4:1.2.3.4:5"}});
};

// Else a client that never reads could make the answers pile up.
TEST_F(WebCallsTest, NothingIsReadUntilARefusalHasLeft) {
  receive(1, "NoSuchMethod");
  ASSERT_EQ(socket_->sent.size(), 1U);
  EXPECT_EQ(socket_->sent[0].status().code(), grpc::UNIMPLEMENTED);
  EXPECT_EQ(socket_->reads, 0);
  socket_->let_go();
  EXPECT_EQ(socket_->reads, 1);
}

TEST_F(WebCallsTest, WhatIsForACallThatHasEndedIsSkipped) {
  receive(7, "");
  EXPECT_TRUE(socket_->sent.empty());
  EXPECT_EQ(socket_->reads, 1);
}

}  // namespace
}  // namespace curvecast::server
