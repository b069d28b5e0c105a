// More connections than there may be, and what is said of them.
#include <gmock/gmock.h>

#include <list>

#include "eventually.h"
#include "has_line.h"
#include "server_fixture.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {
namespace {

class ServerConnections : public ServerFixture {
 protected:
  static grpc::Status call(Stub& stub) {
    grpc::ClientContext context;
    set_patience(context);
    context.set_wait_for_ready(true);  // a connection that gave way is made again
    v1::ListSessionsResponse response;
    return stub.ListSessions(&context, {}, &response);
  }
};

TEST_F(ServerConnections, ThoseThatSayNothingKeepNobodyOut) {
  start({.max_connections = 8, .http = "127.0.0.1:0"});
  const auto first = client();
  ASSERT_TRUE(call(*first).ok());
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = first->StreamViews(&context);
  std::list<HttpClient> silent;
  for (int i = 0; i < 100; ++i) silent.emplace_back(server_->port());
  EXPECT_TRUE(call(*client()).ok());
  EXPECT_EQ(HttpClient(server_->http_port()).get("/readyz").status, 200);
  // Who has made a call stays.
  v1::StreamViewsRequest request;
  request.mutable_open()->set_session_id("nonsense");
  EXPECT_TRUE(stream->Write(request));
  EXPECT_EQ(stream->Finish().error_code(), grpc::NOT_FOUND);
  const std::string text = metrics();
  EXPECT_GE(value_of(text, "curvecast_connections_ended_total"), 90);
  EXPECT_LE(value_of(text, "curvecast_connections"), 8);
  EXPECT_GE(value_of(text, "curvecast_connections"), 2);
}

TEST_F(ServerConnections, ProbesAndMetricsHaveAPortOfTheirOwn) {
  start({.http = "127.0.0.1:0", .admin = "127.0.0.1:0"});
  ASSERT_GT(server_->admin_port(), 0);
  HttpClient admin(server_->admin_port()), http(server_->http_port());
  for (const char* path : {"/healthz", "/readyz"}) {
    EXPECT_EQ(admin.get(path).status, 200) << path;
    EXPECT_EQ(http.get(path).status, 200) << path;
  }
  EXPECT_EQ(http.get("/metrics").status, 404);
  EXPECT_TRUE(has_line(admin.get("/metrics").body, "curvecast_sessions 0"));
  EXPECT_EQ(admin.get("/").status, 404);
  server_->retire();
  EXPECT_EQ(admin.get("/readyz").status, 503);
  EXPECT_EQ(admin.get("/healthz").status, 200);
  EXPECT_TRUE(call(*client()).ok());  // serves on
  const std::string taken = "127.0.0.1:" + std::to_string(server_->admin_port());
  EXPECT_EQ(Server::start({.log = false, .admin = taken}).status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(ServerConnections, AreCountedWhileTheyAreThere) {
  start({.http = "127.0.0.1:0"});
  {
    const auto one = client(), other = client();
    EXPECT_TRUE(call(*one).ok() && call(*other).ok());
    EXPECT_GE(metric("curvecast_connections"), 2);
  }
  // But for the one that asks whether the port answers.
  EXPECT_TRUE(eventually([&] { return metric("curvecast_connections") == 0; }));
  EXPECT_TRUE(has_line(metrics(), "curvecast_connections_refused_total 0"));
}

}  // namespace
}  // namespace curvecast::server
