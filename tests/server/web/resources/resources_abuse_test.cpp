// What must not hurt a server that takes bodies and makes files.
#include <gmock/gmock.h>

#include <chrono>
#include <list>
#include <memory>
#include <thread>

#include "tests/server/eventually.h"
#include "tests/server/web/resources/resources_fixture.h"

namespace curvecast::server {
namespace {

class ResourcesAbuse : public ResourcesFixture {
 protected:
  /// An upload's header, and the first bytes of its body.
  static void begin_upload(HttpClient& client, std::size_t size, const std::string& bytes) {
    client.send(absl::StrCat("PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\nContent-Length: ", size, "\r\n\r\n", bytes));
  }
};

TEST_F(ResourcesAbuse, WhoGoesAwayEndsHisCalls) {
  const std::string mesh = put_sphere(7);
  {
    HttpClient client(server_->http_port());
    client.send(request_text("POST", "/v1/sessions", "{\"meshId\":\"" + mesh + "\",\"options\":{\"maxPoints\":\"4000000\"}}",
                             {{"Content-Type", "application/json"}}));
    ASSERT_TRUE(eventually([&] { return metric("curvecast_sessions") == 1; }));
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_sessions") == 0; })) << "nobody waits for it any more";
  EXPECT_TRUE(has_line(metrics(), "curvecast_requests_total{code=\"CANCELLED\",method=\"CreateSession\"} 1"));
}

TEST_F(ResourcesAbuse, AnUploadThatBreaksOffLeavesNothing) {
  {
    HttpClient client(server_->http_port());
    begin_upload(client, 1'000'000, std::string(300'000, 'x'));
    ASSERT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") > 200'000; }));
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  EXPECT_EQ(get("/v1/sessions").status, 200);
}

TEST_F(ResourcesAbuse, ABodyThatIsLongerThanItSaysIsTheNextRequest) {
  HttpClient client(server_->http_port());
  const std::string mesh = sphere_off(1);
  client.send(request_text("PUT", "/v1/meshes/a.off", mesh) + "XYZ / nonsense\r\n\r\n");
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(client.receive().status, 400);
  EXPECT_TRUE(client.is_closed());
}

TEST_F(ResourcesAbuse, BrokenChunksAreRefused) {
  HttpClient client(server_->http_port());
  client.send(
      "POST /v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nTransfer-Encoding: "
      "chunked\r\n\r\nzz\r\n{}");
  EXPECT_EQ(client.receive().status, 400);
  EXPECT_TRUE(client.is_closed());
  HttpClient both(server_->http_port());
  both.send("PUT /v1/meshes/a HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\n0\r\n\r\n");
  EXPECT_EQ(both.receive().status, 400);
}

TEST_F(ResourcesAbuse, AnEndlessBodyIsNotTakenIn) {
  HttpClient client(server_->http_port());
  client.send(
      "POST /v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n");
  const std::string chunk = absl::StrCat("10000\r\n", std::string(0x10000, ' '), "\r\n");
  int sent = 0;
  while (sent < 1000 && client.send(chunk)) ++sent;
  EXPECT_LT(sent, 1000) << "it was read to its end";
  HttpClient large(server_->http_port());
  begin_upload(large, std::size_t{1} << 50, "OFF");
  EXPECT_EQ(large.receive().status, 413);
  EXPECT_TRUE(large.is_closed());
}

TEST_F(ResourcesAbuse, NobodyHoldsAllConnections) {
  // Bodies that do not come hold their connections up; others are refused, and probes are answered.
  std::list<HttpClient> idle;
  HttpClient::Response refused;
  EXPECT_TRUE(eventually([&] {
    idle.emplace_back(server_->http_port())
        .send("POST /v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{");
    refused = get("/v1/sessions");
    return refused.status == 429;
  })) << refused.status;
  EXPECT_EQ(field_of(refused, "Retry-After"), "1");
  EXPECT_EQ(get("/healthz").status, 200);
  idle.clear();
  EXPECT_TRUE(eventually([&] { return get("/v1/sessions").status == 200; }));
}

TEST_F(ResourcesAbuse, TheServerEndsWhateverIsUnderWay) {
  const std::string mesh = put_sphere(7);
  HttpClient upload(server_->http_port()), making(server_->http_port());
  begin_upload(upload, 1'000'000, std::string(300'000, 'x'));
  making.send(request_text("POST", "/v1/sessions", "{\"meshId\":\"" + mesh + "\",\"options\":{\"maxPoints\":\"4000000\"}}",
                           {{"Content-Type", "application/json"}}));
  ASSERT_TRUE(eventually([&] { return metric("curvecast_sessions") == 1 && metric("curvecast_mesh_bytes") > 200'000; }));
  server_->shutdown(std::chrono::milliseconds(0));
  const auto answer = making.receive();
  EXPECT_TRUE(answer.status == 499 || answer.status == 503) << answer.status << answer.body;
  server_.reset();
  EXPECT_TRUE(upload.is_closed() || upload.receive().status != 201);
}

TEST_F(ResourcesAbuse, ManyAtOnceAreAnswered) {
  const std::string points = "/v1/sessions/" + make_session() + "/points.npz?n=5000&seed=";
  std::vector<std::thread> threads;
  std::atomic<int> good = 0;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      HttpClient client(server_->http_port());
      for (int i = 0; i < 20; ++i) good += client.get(points + std::to_string(100 * t + i)).status == 200 ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 160);
}

}  // namespace
}  // namespace curvecast::server
