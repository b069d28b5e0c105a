// Starting, stopping, health and hostile bytes.
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <future>
#include <thread>

#include "server_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerLifecycle : public ServerFixture {};

struct Answer {
  grpc::Status status;
  std::string bytes;
};

// Sends one message of the given bytes and returns the first one that comes back.
Answer call(const std::shared_ptr<grpc::Channel>& channel, const std::string& method, const std::string& bytes) {
  grpc::GenericStub stub(channel);
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub.PrepareCall(&context, method, &queue);
  void* tag = nullptr;
  const auto wait = [&] {
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  stream->StartCall(nullptr);
  wait();
  const grpc::Slice slice(bytes);
  stream->WriteLast(grpc::ByteBuffer(&slice, 1), {}, nullptr);
  wait();
  Answer answer;
  grpc::ByteBuffer buffer;
  stream->Read(&buffer, nullptr);
  if (wait()) {
    std::vector<grpc::Slice> slices;
    EXPECT_TRUE(buffer.Dump(&slices).ok());
    for (const auto& part : slices) answer.bytes.append(reinterpret_cast<const char*>(part.begin()), part.size());
  }
  stream->Finish(&answer.status, nullptr);
  wait();
  queue.Shutdown();
  while (queue.Next(&tag, nullptr)) {
  }
  return answer;
}

// A HealthCheckRequest with `service` as its field 1; a HealthCheckResponse with the status in its field 1.
std::string health(const std::shared_ptr<grpc::Channel>& channel, const std::string& service) {
  const std::string request = service.empty() ? "" : std::string("\x0a") + static_cast<char>(service.size()) + service;
  const Answer answer = call(channel, "/grpc.health.v1.Health/Check", request);
  return answer.status.ok() ? answer.bytes : answer.status.error_message();
}

const char kServing[] = "\x08\x01";

TEST_F(ServerLifecycle, AnswersHealthChecks) {
  EXPECT_EQ(health(connect(), ""), kServing);
  EXPECT_EQ(health(connect(), "curvecast.v1.CurvecastService"), kServing);
  EXPECT_NE(health(connect(), "nonsense"), kServing);
}

TEST_F(ServerLifecycle, IsHealthyWhenItIsReady) {
  start({.ready = false});
  for (const char* service : {"", "curvecast.v1.CurvecastService"}) EXPECT_EQ(health(connect(), service), "\x08\x02") << service;
  server_->set_ready();
  for (const char* service : {"", "curvecast.v1.CurvecastService"}) EXPECT_EQ(health(connect(), service), kServing) << service;
}

// Watches the health of a service until it changes, which is what a load balancer does.
TEST_F(ServerLifecycle, TellsThoseWhoWatchBeforeItEnds) {
  grpc::GenericStub stub(connect());
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub.PrepareCall(&context, "/grpc.health.v1.Health/Watch", &queue);
  void* tag = nullptr;
  bool ok = false;
  const auto read = [&] {
    grpc::ByteBuffer buffer;
    stream->Read(&buffer, nullptr);
    EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
    grpc::Slice slice;
    EXPECT_TRUE(buffer.DumpToSingleSlice(&slice).ok());
    return std::string(reinterpret_cast<const char*>(slice.begin()), slice.size());
  };
  stream->StartCall(nullptr);
  EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
  const std::string service = "curvecast.v1.CurvecastService";
  const grpc::Slice request(std::string("\x0a") + static_cast<char>(service.size()) + service);
  stream->WriteLast(grpc::ByteBuffer(&request, 1), {}, nullptr);
  EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
  EXPECT_EQ(read(), kServing);
  std::thread stopper([this] { server_->shutdown(std::chrono::seconds(100)); });
  EXPECT_EQ(read(), "\x08\x02");  // NOT_SERVING, while the call goes on
  context.TryCancel();
  stopper.join();
  grpc::Status status;
  stream->Finish(&status, nullptr);
  queue.Next(&tag, &ok);
  queue.Shutdown();
  while (queue.Next(&tag, nullptr)) {
  }
}

TEST_F(ServerLifecycle, SurvivesHostileBytes) {
  const auto channel = connect();
  for (const char* method : {"UploadMesh", "GetMesh", "InspectMesh", "CreateSession", "GetSession", "CloseSession", "Resample",
                             "StreamViews", "Nonsense"}) {
    for (const std::string& bytes : {std::string(1000, '\xff'), std::string("\x0a\xff\xff\xff\xff\x0f"),
                                     std::string("\x0a\x02\xc3\x28"), std::string(3 << 20, '\n'), std::string()}) {
      EXPECT_FALSE(call(channel, std::string("/curvecast.v1.CurvecastService/") + method, bytes).status.ok()) << method;
    }
  }
  EXPECT_EQ(health(channel, ""), kServing);
}

TEST_F(ServerLifecycle, SaysWhyItCannotListen) {
  const auto taken = Server::start({.listen = address(), .log = false});
  EXPECT_EQ(taken.status().code(), absl::StatusCode::kUnavailable) << taken.status();
  for (const char* malformed : {"nonsense", ":50051", "127.0.0.1:", "127.0.0.1:http", "127.0.0.1:65536", "127.0.0.1:-1"}) {
    const auto server = Server::start({.listen = malformed, .log = false});
    EXPECT_EQ(server.status().code(), absl::StatusCode::kInvalidArgument) << malformed;
    EXPECT_THAT(server.status().message(), HasSubstr(malformed));
  }
  EXPECT_EQ(Server::start({.threads = -1, .log = false}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(health(connect(), ""), kServing);
}

TEST_F(ServerLifecycle, ServesItsOwnProcessWithoutASocket) {
  const auto server = Server::start({.log = false});
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ((*server)->port(), 0);
  const auto stub = v1::CurvecastService::NewStub((*server)->in_process_channel());
  const Created created = create(*stub, upload(*stub, sphere_off(3)), 1000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_EQ(resample(*stub, created.session.session_id(), view_of(1000)).points(), 1000u);
  EXPECT_EQ(health((*server)->in_process_channel(), ""), kServing);
}

TEST_F(ServerLifecycle, ShutdownStopsPreprocessing) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(6));
  grpc::ClientContext context;
  set_patience(context);
  v1::CreateSessionRequest request;
  request.set_mesh_id(mesh);
  request.mutable_options()->set_max_points(500'000);
  const auto reader = stub->CreateSession(&context, request);
  v1::CreateSessionResponse response;
  ASSERT_TRUE(reader->Read(&response));
  server_->shutdown(std::chrono::milliseconds(0));
  server_->shutdown(std::chrono::milliseconds(0));  // harmless
  while (reader->Read(&response)) {
  }
  EXPECT_EQ(reader->Finish().ok(), response.has_session());  // unless preprocessing was over before
}

TEST_F(ServerLifecycle, DrainLetsRunningCallsEnd) {
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
  while (reader->Read(&response)) {
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_TRUE(response.has_session());
  stopper.join();
  grpc::ClientContext late;
  EXPECT_FALSE(stub->ListSessions(&late, {}, std::make_unique<v1::ListSessionsResponse>().get()).ok());
}

}  // namespace
}  // namespace curvecast::server
