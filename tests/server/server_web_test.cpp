// The HTTP port of a whole server: what it says of itself, and what it has counted.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <thread>

#include "eventually.h"
#include "has_line.h"
#include "server/engine/request_log.h"
#include "server_fixture.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class ServerWeb : public ServerFixture {
 protected:
  void SetUp() override { start({.http = "127.0.0.1:0"}); }
  HttpClient::Response get(const std::string& path) const { return HttpClient(server_->http_port()).get(path); }
};

TEST_F(ServerWeb, IsReadyWhenItSaysSo) {
  EXPECT_EQ(get("/readyz").status, 200);
  start({.http = "127.0.0.1:0", .ready = false});
  EXPECT_EQ(get("/healthz").status, 200);
  const auto early = get("/readyz");
  EXPECT_EQ(early.status, 503);
  EXPECT_EQ(early.body, "meshes are being prepared\n");
  server_->set_ready();
  EXPECT_EQ(get("/readyz").status, 200);
  server_->shutdown(std::chrono::seconds(1));
  server_->set_ready();
  EXPECT_EQ(get("/healthz").status, 200);  // the process still serves that
  EXPECT_EQ(get("/readyz").status, 503);
}

TEST_F(ServerWeb, IsNotReadyWhileItDrains) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(4));
  grpc::ClientContext context;
  set_patience(context);
  v1::CreateSessionRequest request;
  request.set_mesh_id(mesh);
  request.mutable_options()->set_max_points(2000);
  const auto reader = stub->CreateSession(&context, request);
  v1::CreateSessionResponse response;
  ASSERT_TRUE(reader->Read(&response));
  std::thread stopper([this] { server_->shutdown(std::chrono::seconds(100)); });
  HttpClient::Response answer;
  EXPECT_TRUE(eventually([&] {
    answer = get("/readyz");
    return answer.status != 200;
  }));
  EXPECT_EQ(answer.status, 503);
  EXPECT_THAT(answer.body, HasSubstr("shutting down"));
  while (reader->Read(&response)) {
  }
  EXPECT_TRUE(reader->Finish().ok());
  stopper.join();
}

TEST_F(ServerWeb, SaysWhyItCannotListen) {
  const std::string taken = "127.0.0.1:" + std::to_string(server_->http_port());
  const auto second = Server::start({.log = false, .http = taken});
  EXPECT_EQ(second.status().code(), absl::StatusCode::kUnavailable) << second.status();
  EXPECT_THAT(second.status().message(), HasSubstr(taken));
  EXPECT_EQ(Server::start({.log = false, .http = "nonsense"}).status().code(), absl::StatusCode::kInvalidArgument);
  start({});
  EXPECT_EQ(server_->http_port(), 0);
}

TEST_F(ServerWeb, CountsWhatClientsDo) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(3));
  const Created created = create(*stub, mesh, 1000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_EQ(resample(*stub, created.session.session_id(), view_of(1000)).points(), 1000u);
  EXPECT_EQ(resample(*stub, "nonsense", view_of(10)).status.error_code(), grpc::NOT_FOUND);
  {
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub->StreamViews(&context);
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(created.session.session_id());
    ASSERT_TRUE(stream->Write(request));
    *request.mutable_view()->mutable_sample() = view_of(500);
    request.mutable_view()->set_sequence(1);
    ASSERT_TRUE(stream->Write(request));
    v1::StreamViewsResponse response;
    ASSERT_TRUE(stream->Read(&response));
    EXPECT_TRUE(has_line(metrics(), "curvecast_open_streams 1"));
    request.mutable_view()->mutable_sample()->set_points(0);
    request.mutable_view()->set_sequence(2);
    ASSERT_TRUE(stream->Write(request));
    stream->WritesDone();
    while (stream->Read(&response)) {
    }
    EXPECT_TRUE(stream->Finish().ok());
  }
  // The reactor may take a moment to go after its client has heard the end.
  std::string text;
  EXPECT_TRUE(eventually([&] {
    text = metrics();
    return has_line(text, "curvecast_open_streams 0");
  }));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"OK\",method=\"UploadMesh\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"OK\",method=\"CreateSession\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"OK\",method=\"Resample\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"NOT_FOUND\",method=\"Resample\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_requests_total{code=\"OK\",method=\"StreamViews\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_views_received_total 2"));
  EXPECT_TRUE(has_line(text, "curvecast_views_answered_total 2"));
  EXPECT_TRUE(has_line(text, "curvecast_views_overtaken_total 0"));
  EXPECT_TRUE(has_line(text, "curvecast_frames_total{kind=\"error\"} 1"));
  EXPECT_TRUE(has_line(text, "curvecast_sessions 1"));
  EXPECT_TRUE(has_line(text, "curvecast_meshes 1"));
  EXPECT_TRUE(has_line(text, "curvecast_queue_depth{queue=\"views\"} 0"));
  EXPECT_THAT(text, HasSubstr("\ncurvecast_build_info{"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("curvecast_session_bytes 0\n")));
  EXPECT_THAT(get("/metrics").header, HasSubstr("text/plain; version=0.0.4"));
}

TEST_F(ServerWeb, RequestsHaveIds) {
  const auto stub = client();
  const auto id_of = [&](const char* sent) {
    grpc::ClientContext context;
    set_patience(context);
    if (sent != nullptr) context.AddMetadata("x-request-id", sent);
    v1::ListSessionsResponse response;
    EXPECT_TRUE(stub->ListSessions(&context, {}, &response).ok());
    const auto found = context.GetServerInitialMetadata().find("x-request-id");
    return found == context.GetServerInitialMetadata().end() ? "" : std::string(found->second.data(), found->second.size());
  };
  EXPECT_EQ(id_of("abc-123:of(mine)"), "abc-123:of(mine)");
  EXPECT_THAT(id_of("1, peer ipv4:10.0.0.1:1"), MatchesRegex("[0-9a-f]{16}")) << "it could pretend further fields in the log";
  EXPECT_EQ(id_of(std::string(64, 'a').c_str()), std::string(64, 'a'));
  EXPECT_THAT(id_of(std::string(65, 'a').c_str()), MatchesRegex("[0-9a-f]{16}"));
  const std::string first = id_of(nullptr);
  EXPECT_THAT(first, MatchesRegex("[0-9a-f]{16}"));
  EXPECT_NE(first, id_of(nullptr));
  EXPECT_FALSE(is_request_id(""));
  EXPECT_FALSE(is_request_id("a\nb"));
  EXPECT_FALSE(is_request_id("\xc3\xa9"));
}

TEST_F(ServerWeb, StreamsHaveIdsToo) {
  const auto stub = client();
  grpc::ClientContext context;
  set_patience(context);
  context.AddMetadata("x-request-id", "mine");
  const auto stream = stub->StreamViews(&context);
  stream->WritesDone();
  EXPECT_FALSE(stream->Finish().ok());  // for there was no open
  const auto& metadata = context.GetServerInitialMetadata();
  const auto found = metadata.find("x-request-id");
  ASSERT_NE(found, metadata.end());
  EXPECT_EQ(std::string(found->second.data(), found->second.size()), "mine");
}

}  // namespace
}  // namespace curvecast::server
