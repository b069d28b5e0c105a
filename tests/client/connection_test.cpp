#include "client/lib/connection.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/lib/retry.h"
#include "client/lib/routing_key.h"
#include "curvecast/v1/curvecast.grpc.pb.h"
#include "curvecast/v1/status.pb.h"
#include "tests/server/eventually.h"

namespace curvecast::client {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr auto kPatience = std::chrono::seconds(60);  // only what is broken takes that long

/// Ends each call with the next status of a script, or does what it is asked when the script is over.
class ScriptedService : public v1::CurvecastService::Service {
 public:
  void fail_with(std::deque<grpc::Status> statuses) {
    const std::lock_guard lock(mutex_);
    script_ = std::move(statuses);
  }
  int calls() const { return calls_; }
  void wait_for_call() {
    EXPECT_TRUE(server::eventually([this] { return calls_ > 0; })) << "no call has come";
  }
  std::string uploaded() {
    const std::lock_guard lock(mutex_);
    return uploaded_;
  }
  /// The keys of the calls so far, "" where one has none.
  std::vector<std::string> keys() {
    const std::lock_guard lock(mutex_);
    return keys_;
  }
  std::atomic<bool> hang = false;  // until cancelled, or out of patience

  grpc::Status GetMesh(grpc::ServerContext* context, const v1::GetMeshRequest* request, v1::GetMeshResponse* response) override {
    response->set_mesh_id(request->mesh_id());
    return next(context);
  }
  grpc::Status UploadMesh(grpc::ServerContext* context, grpc::ServerReader<v1::UploadMeshRequest>* reader,
                          v1::UploadMeshResponse* response) override {
    std::string bytes;
    v1::UploadMeshRequest message;
    const grpc::Status status = next(context);
    if (!status.ok()) return status;  // before all chunks have come
    while (reader->Read(&message)) {
      EXPECT_LE(message.chunk().size(), std::size_t{1} << 20);
      bytes += message.chunk();
    }
    response->set_size(bytes.size());
    const std::lock_guard lock(mutex_);
    uploaded_ = std::move(bytes);
    return status;
  }
  grpc::Status CreateSession(grpc::ServerContext* context, const v1::CreateSessionRequest*,
                             grpc::ServerWriter<v1::CreateSessionResponse>* writer) override {
    v1::CreateSessionResponse response;
    response.mutable_progress()->set_stage("cut");
    writer->Write(response);
    const grpc::Status status = next(context);
    response.mutable_session()->set_session_id("s");
    if (status.ok() && !without_session) writer->Write(response);
    return status;
  }
  grpc::Status ListSessions(grpc::ServerContext* context, const v1::ListSessionsRequest*, v1::ListSessionsResponse*) override {
    return next(context);
  }
  grpc::Status StreamViews(grpc::ServerContext* context,
                           grpc::ServerReaderWriter<v1::StreamViewsResponse, v1::StreamViewsRequest>*) override {
    return next(context);
  }
  grpc::Status CloseSession(grpc::ServerContext* context, const v1::CloseSessionRequest*, v1::CloseSessionResponse*) override {
    return next(context);
  }
  grpc::Status Resample(grpc::ServerContext* context, const v1::ResampleRequest*,
                        grpc::ServerWriter<v1::ResampleResponse>* writer) override {
    v1::ResampleResponse response;
    response.mutable_points()->set_count(5);
    writer->Write(response);
    const grpc::Status status = next(context);
    for (int i = 0; i < blocks && status.ok(); ++i) writer->Write(response);
    return status;
  }
  std::atomic<int> blocks = 1;  // of Resample, after the first
  std::atomic<bool> without_session = false;

 private:
  grpc::Status next(grpc::ServerContext* context) {
    ++calls_;
    EXPECT_TRUE(server::eventually([&] { return !hang || context->IsCancelled(); }));
    const auto& metadata = context->client_metadata();
    const auto key = metadata.find(kRoutingKey);
    const std::lock_guard lock(mutex_);
    keys_.push_back(key == metadata.end() ? "" : std::string(key->second.data(), key->second.size()));
    if (script_.empty()) return grpc::Status::OK;
    grpc::Status status = script_.front();
    script_.pop_front();
    return status;
  }

  std::mutex mutex_;
  std::deque<grpc::Status> script_;
  std::atomic<int> calls_ = 0;
  std::string uploaded_;
  std::vector<std::string> keys_;
};

const grpc::Status kUnavailable(grpc::StatusCode::UNAVAILABLE, "gone");
const grpc::Status kReset(grpc::StatusCode::INTERNAL, "Received RST_STREAM with error code 2");
const grpc::Status kCancelled(grpc::StatusCode::CANCELLED, "the proxy lost its server");

class ConnectionTest : public ::testing::Test {
 protected:
  ConnectionTest() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    ConnectionOptions options;
    options.retry = {.attempts = 4, .first_delay = milliseconds(1), .longest_delay = milliseconds(4)};
    connection_ = make_connection(server_->InProcessChannel({}), options);
  }
  ~ConnectionTest() override { server_->Shutdown(); }

  absl::StatusOr<v1::GetMeshResponse> get_mesh(std::stop_token stop = {}) {
    v1::GetMeshRequest request;
    request.set_mesh_id("m");
    return connection_->get_mesh(request, stop);
  }

  ScriptedService service_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<Connection> connection_;
};

TEST_F(ConnectionTest, RepeatsWhatMayPass) {
  service_.fail_with({kUnavailable, kReset, kCancelled});
  const auto response = get_mesh();
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(response->mesh_id(), "m");
  EXPECT_EQ(service_.calls(), 4);
}

TEST_F(ConnectionTest, GivesUpAfterTheLastAttempt) {
  service_.fail_with({kUnavailable, kUnavailable, kUnavailable, kUnavailable, kUnavailable});
  const absl::Status status = get_mesh().status();
  EXPECT_TRUE(absl::IsUnavailable(status));
  EXPECT_EQ(status.message(), "gone");
  EXPECT_EQ(service_.calls(), 4);
}

TEST_F(ConnectionTest, DoesNotRepeatWhatStaysWrong) {
  int calls = 0;
  for (const grpc::StatusCode code :
       {grpc::StatusCode::NOT_FOUND, grpc::StatusCode::INVALID_ARGUMENT, grpc::StatusCode::OUT_OF_RANGE,
        grpc::StatusCode::FAILED_PRECONDITION, grpc::StatusCode::RESOURCE_EXHAUSTED, grpc::StatusCode::INTERNAL,
        grpc::StatusCode::UNKNOWN, grpc::StatusCode::DEADLINE_EXCEEDED, grpc::StatusCode::UNIMPLEMENTED}) {
    service_.fail_with({grpc::Status(code, "why")});
    const absl::Status status = get_mesh().status();
    EXPECT_EQ(static_cast<int>(status.code()), static_cast<int>(code));
    EXPECT_EQ(status.message(), "why");
    EXPECT_EQ(service_.calls(), ++calls);
  }
}

TEST_F(ConnectionTest, CallsTellProxiesWhichMeshTheyAreAbout) {
  const std::string mesh = "0123456789abcdef0000000000000000", session = "0123456789abcdef1111111111111111";
  v1::UploadHeader header;
  header.set_mesh_id(mesh);
  v1::GetMeshRequest get;
  get.set_mesh_id(mesh);
  v1::CreateSessionRequest create;
  create.set_mesh_id(mesh);
  v1::ResampleRequest resample;
  resample.set_session_id(session);
  v1::CloseSessionRequest close;
  close.set_session_id(session);
  EXPECT_TRUE(connection_->upload_mesh(header, {}, {}, {}).ok());
  EXPECT_TRUE(connection_->get_mesh(get, {}).ok());
  EXPECT_TRUE(connection_->create_session(create, {}, {}).ok());
  EXPECT_TRUE(connection_->resample(resample, {}).ok());
  EXPECT_TRUE(connection_->close_session(close, {}).ok());
  v1::OpenView open;
  open.set_session_id(session);
  v1::StreamViewsResponse none;
  const std::unique_ptr<ViewCall> stream = connection_->stream_views(open, {});
  EXPECT_FALSE(stream->read(&none));
  EXPECT_TRUE(stream->finish().ok());
  EXPECT_EQ(service_.keys(), std::vector<std::string>(6, "0123456789abcdef"));
  EXPECT_TRUE(connection_->list_sessions({}, {}).ok());
  EXPECT_EQ(service_.keys().back(), "");
}

TEST_F(ConnectionTest, TellsWhenToTryAgain) {
  v1::RetryInfo info;
  info.mutable_retry_delay()->set_seconds(7);
  v1::Status rich;
  rich.add_details()->set_type_url("type.googleapis.com/google.rpc.BadRequest");
  rich.add_details()->set_type_url(kRetryInfo);
  rich.mutable_details(1)->set_value(info.SerializeAsString());
  service_.fail_with({grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "full", rich.SerializeAsString()),
                      grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "full", "no details at all")});
  EXPECT_EQ(retry_after(get_mesh().status()), std::chrono::seconds(7));
  EXPECT_FALSE(retry_after(get_mesh().status()).has_value());
}

TEST_F(ConnectionTest, NeverRepeatsCloseSession) {
  service_.fail_with({kUnavailable});
  EXPECT_TRUE(absl::IsUnavailable(connection_->close_session({}, {})));
  EXPECT_EQ(service_.calls(), 1);
}

TEST_F(ConnectionTest, RepeatsAnUploadFromItsStart) {
  std::string bytes(3'000'001, 'x');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 2'654'435'761U >> 24);
  service_.fail_with({kUnavailable, kReset});
  v1::UploadHeader header;
  header.set_size(bytes.size());
  std::uint64_t last = 0;
  const auto response = connection_->upload_mesh(
      header,
      [&](std::uint64_t offset, std::span<char> out) {
        bytes.copy(out.data(), out.size(), offset);
        return absl::OkStatus();
      },
      [&](std::uint64_t sent) { last = sent; }, {});
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(service_.uploaded(), bytes);
  EXPECT_EQ(last, bytes.size());
}

TEST_F(ConnectionTest, EndsAnUploadWhoseFileCannotBeRead) {
  v1::UploadHeader header;
  header.set_size(10);
  const auto read = [](std::uint64_t, std::span<char>) { return absl::FailedPreconditionError("became shorter"); };
  EXPECT_EQ(connection_->upload_mesh(header, read, {}, {}).status().message(), "became shorter");
}

TEST_F(ConnectionTest, ForwardsProgressAndReturnsTheSession) {
  service_.fail_with({kUnavailable});
  int progress = 0;
  const auto session = connection_->create_session({}, [&](const v1::Progress& p) { progress += p.stage() == "cut"; }, {});
  ASSERT_TRUE(session.ok()) << session.status();
  EXPECT_EQ(session->session_id(), "s");
  EXPECT_EQ(progress, 2);
  service_.without_session = true;
  EXPECT_TRUE(absl::IsDataLoss(connection_->create_session({}, {}, {}).status()));
}

TEST_F(ConnectionTest, DropsBlocksOfAFailedAttempt) {
  service_.fail_with({kUnavailable, kUnavailable});
  v1::ResampleRequest request;
  request.mutable_sample()->set_points(10);
  const auto responses = connection_->resample(request, {});
  ASSERT_TRUE(responses.ok()) << responses.status();
  EXPECT_EQ(responses->size(), 2U);
}

TEST_F(ConnectionTest, StopsAServerThatSendsTooMuch) {
  service_.blocks = 1'000'000;
  v1::ResampleRequest request;
  request.mutable_sample()->set_points(100);
  EXPECT_TRUE(absl::IsDataLoss(connection_->resample(request, {}).status()));
}

TEST_F(ConnectionTest, StopEndsARunningCallWithoutRetry) {
  service_.hang = true;
  std::stop_source stop;
  std::thread stopper([&] {
    service_.wait_for_call();
    stop.request_stop();
  });
  EXPECT_TRUE(absl::IsCancelled(get_mesh(stop.get_token()).status()));
  stopper.join();
  EXPECT_EQ(service_.calls(), 1);
}

TEST_F(ConnectionTest, StopEndsTheWaitBetweenAttempts) {
  ConnectionOptions options;
  options.retry = {.attempts = 2, .first_delay = kPatience, .longest_delay = kPatience};
  const auto patient = make_connection(server_->InProcessChannel({}), options);
  service_.fail_with({kUnavailable});
  std::stop_source stop;
  std::thread stopper([&] {
    service_.wait_for_call();
    stop.request_stop();
  });
  EXPECT_TRUE(absl::IsCancelled(patient->get_mesh({}, stop.get_token()).status()));
  stopper.join();
}

TEST_F(ConnectionTest, DeadlinesEndCallsThatHang) {
  service_.hang = true;
  ConnectionOptions options;
  options.short_timeout = milliseconds(20);
  const auto hasty = make_connection(server_->InProcessChannel({}), options);
  EXPECT_TRUE(absl::IsDeadlineExceeded(hasty->get_mesh({}, {}).status()));
}

TEST(TcpConnection, SaysWhenNobodyListens) {
  ConnectionOptions options;
  options.retry = {.attempts = 2, .first_delay = milliseconds(1), .longest_delay = milliseconds(1)};
  const auto connection = make_connection(tcp_channel("127.0.0.1:1"), options);
  EXPECT_TRUE(absl::IsUnavailable(connection->list_sessions({}, {}).status()));
}

}  // namespace
}  // namespace curvecast::client
