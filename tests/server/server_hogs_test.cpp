// Clients that take all they can get: others do not notice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/base/hash.h"
#include "tests/server/eventually.h"
#include "tests/server/opened_stream.h"
#include "tests/server/server_fixture.h"
#include "tests/server/two_callers.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

constexpr auto kRefused = static_cast<std::uint32_t>(grpc::RESOURCE_EXHAUSTED);

class ServerHogs : public ServerFixture {
 protected:
  void SetUp() override {}
  /// Without refinement, which would send better frames.
  void start(ServerOptions options) {
    testing::write_file(folder_ / "tokens", kTokens);
    options.tokens = folder_ / "tokens";
    options.http = "127.0.0.1:0";
    options.max_curve_vertices = 0;
    ServerFixture::start(options);
    anna_ = client_with("anna's"), bert_ = client_with("bert's");
  }
  std::string make_session(std::uint64_t points) {
    return create(*anna_, upload(*anna_, sphere_off(3)), points).session.session_id();
  }

  const testing::TemporaryFolder folder_;
  std::unique_ptr<Stub> anna_, bert_;
};

/// Eleven megabytes: more than gRPC takes off our hands.
v1::SampleRequest large_view() {
  v1::SampleRequest sample = view_of(400'000);
  sample.mutable_encoding()->mutable_raw();
  return sample;
}

/// Formulas of so many powers each, which are slow.
v1::SampleRequest view_with_formulas(int terms, int powers) {
  v1::SampleRequest sample = view_of(100);
  std::string tower = "x";
  for (int i = 0; i < powers; ++i) tower += "^x";
  for (int i = 0; i < terms; ++i) sample.add_density()->mutable_expression()->set_text("2+" + tower);
  return sample;
}

TEST_F(ServerHogs, WhoDoesNotReadIsRefusedNotTheOthers) {
  start({.max_queued_bytes = 64 << 20});
  const std::string session = make_session(2000);
  // Clients that never read: gRPC takes some of their frames off our hands, the rest is counted.
  std::vector<std::unique_ptr<OpenedStream>> lazy;
  bool is_refused = false;
  for (int i = 0; i < 100 && !is_refused; ++i) {
    lazy.push_back(std::make_unique<OpenedStream>(*anna_, session));
    for (std::uint64_t s = 1; s <= 2; ++s) lazy.back()->ask(s, large_view());
    OpenedStream polite(*bert_, session);
    polite.ask(1, 10);
    ASSERT_EQ(polite.read().error().message(), "");
    OpenedStream another(*anna_, session);
    another.ask(1, 10);
    const v1::PointFrame frame = another.read();
    is_refused = frame.error().code() == kRefused;
    EXPECT_GE(frame.error().retry_after(), is_refused ? 1 : 0);
  }
  EXPECT_TRUE(is_refused);
  lazy.clear();
  // When they have gone, there is room again.
  EXPECT_TRUE(eventually([&] {
    OpenedStream another(*anna_, session);
    another.ask(1, 10);
    return another.read().error().code() == 0;
  }));
}

TEST_F(ServerHogs, AStreamThatIsNotReadEndsWhereMemoryIsScarce) {
  start({.max_queued_bytes = 12'000'000, .max_stall = std::chrono::milliseconds(0)});
  const std::string session = make_session(2000);
  OpenedStream lazy(*anna_, session);
  lazy.ask(1, large_view());
  EXPECT_TRUE(eventually([&] { return metric("curvecast_views_answered_total") == 1; }));
  EXPECT_TRUE(eventually([&] { return metric("curvecast_open_streams") == 0; }));
  while (lazy.read().sequence() != 0) continue;
  const grpc::Status status = lazy.stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("not read"));
}

TEST_F(ServerHogs, APointSetThatIsNotReadEndsWhereMemoryIsScarce) {
  // Room for all of it: what gRPC takes off our hands leaves more than half of that.
  start({.max_queued_bytes = 60'000'000, .max_stall = std::chrono::milliseconds(0)});
  v1::ResampleRequest request;
  request.set_session_id(make_session(2000));
  *request.mutable_sample() = large_view();
  request.mutable_sample()->set_points(2'000'000);
  grpc::ClientContext context;
  set_patience(context);
  const auto lazy = anna_->Resample(&context, request);
  EXPECT_TRUE(eventually([&] { return metric("curvecast_stalled_calls_total") >= 1; }));
  EXPECT_TRUE(eventually([&] { return metric("curvecast_queued_bytes") == 0; }));
  v1::ResampleResponse block;
  while (lazy->Read(&block)) continue;
  EXPECT_EQ(lazy->Finish().error_code(), grpc::RESOURCE_EXHAUSTED);
}

TEST_F(ServerHogs, AnUploadThatBringsNothingIsPutAside) {
  start({.max_uploads_of_client = 1, .max_stall = std::chrono::milliseconds(1500)});
  const std::string bytes = sphere_off(3);
  Hasher hasher;
  hasher.update(bytes);
  v1::UploadHeader header;
  header.set_size(bytes.size());
  header.set_mesh_id(hasher.hex());
  grpc::ClientContext context;
  set_patience(context);
  v1::UploadMeshResponse response;
  const auto writer = anna_->UploadMesh(&context, &response);
  v1::UploadMeshRequest request;
  *request.mutable_header() = header;
  writer->Write(request);
  request.set_chunk(bytes.substr(0, 1000));
  writer->Write(request);
  const grpc::Status status = writer->Finish();
  EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("nothing has come"));
  header.set_offset(1000);
  const auto go_on = [&](Stub& stub) { return upload(stub, header, bytes.substr(1000)).status; };
  EXPECT_EQ(go_on(*bert_).error_code(), grpc::FAILED_PRECONDITION) << "it is not his";
  grpc::Status last;
  EXPECT_TRUE(eventually([&] { return (last = go_on(*anna_)).ok(); })) << last.error_message();
}

TEST_F(ServerHogs, SessionsInTheMakingAreNotOneCallersAlone) {
  start({.max_sessions_in_making_of_client = 1});
  const std::string mesh = upload(*anna_, sphere_off(5));
  v1::CreateSessionRequest request;
  request.set_mesh_id(mesh);
  request.mutable_options()->set_max_points(3'000'000);  // takes a while
  std::optional<grpc::ClientContext> context(std::in_place);
  set_patience(*context);
  context->AddMetadata("authorization", "Bearer anna's");
  auto making = client()->CreateSession(&*context, request);
  v1::CreateSessionResponse progress;
  ASSERT_TRUE(making->Read(&progress));
  const Created second = create(*anna_, mesh, 1000);
  EXPECT_EQ(second.status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(second.status.error_message(), HasSubstr("you have 1 sessions in the making"));
  // Another one's goes before the long one or after it, but is not refused.
  std::jthread other([&] { EXPECT_TRUE(create(*bert_, mesh, 1001).status.ok()); });
  context->TryCancel();
  EXPECT_TRUE(eventually([&] { return create(*anna_, mesh, 1000).status.ok(); }));
}

TEST_F(ServerHogs, AGreatMeshDoesNotHoldUpSmallOnes) {
  start({});
  v1::CreateSessionRequest request;
  request.set_mesh_id(upload(*anna_, sphere_off(7)));
  request.mutable_options()->set_parameteriser(v1::PARAMETERISER_CGAL);  // takes ten seconds
  grpc::ClientContext context;
  set_patience(context);
  context.AddMetadata("authorization", "Bearer anna's");
  const auto great = client()->CreateSession(&context, request);
  v1::CreateSessionResponse response;
  do {
    ASSERT_TRUE(great->Read(&response));
  } while (response.progress().stage() == "queued");
  const std::string small = upload(*bert_, sphere_off(2));
  for (std::uint64_t points = 1; points <= 50; ++points) EXPECT_TRUE(create(*bert_, small, points).status.ok());
  v1::ListSessionsResponse sessions;
  grpc::ClientContext listing;
  set_patience(listing);
  ASSERT_TRUE(anna_->ListSessions(&listing, {}, &sessions).ok());
  int ready = 0;
  for (const v1::Session& session : sessions.sessions()) ready += session.state() == v1::SESSION_STATE_READY ? 1 : 0;
  EXPECT_EQ(ready, 50) << "the great one is still in the making";
  context.TryCancel();
}

TEST_F(ServerHogs, StreamsEndAtTheirAge) {
  start({.max_stream_age = std::chrono::seconds(1)});
  OpenedStream stream(*anna_, make_session(2000));
  stream.ask(1, 100);
  EXPECT_EQ(stream.read().sequence(), 1u);
  stream.acknowledge(1);
  while (stream.read().sequence() != 0) continue;
  const grpc::Status status = stream.stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("age"));
}

TEST_F(ServerHogs, ACostlyFormulaIsRefusedWithItsBound) {
  start({});
  OpenedStream stream(*anna_, make_session(10'000));
  stream.ask(1, view_with_formulas(1, 490));
  const v1::PointFrame frame = stream.read();
  EXPECT_EQ(frame.error().code(), static_cast<std::uint32_t>(grpc::INVALID_ARGUMENT));
  EXPECT_THAT(frame.error().message(), HasSubstr("'2+x^x^x"));
  EXPECT_THAT(frame.error().message(), HasSubstr("at most 1000000000 are done"));
}

TEST_F(ServerHogs, FormulasThatTakeLongEndAndTheNewerViewComes) {
  start({});
  OpenedStream stream(*anna_, make_session(10'000));
  stream.ask(1, view_with_formulas(13, 200));
  const v1::PointFrame frame = stream.read();
  EXPECT_EQ(frame.error().code(), static_cast<std::uint32_t>(grpc::DEADLINE_EXCEEDED));
  EXPECT_THAT(frame.error().message(), HasSubstr("'2+x^x^x"));
  stream.acknowledge(1);
  stream.ask(2, view_with_formulas(13, 201));
  stream.ask(3, 10);
  EXPECT_EQ(stream.read().sequence(), 3u) << "nobody waits for the older one any more";
}

TEST_F(ServerHogs, ManyConnectionsOfOneDoNotHoldUpAnother) {
  start({.threads = 1});
  const std::string session = make_session(10'000);
  std::vector<std::unique_ptr<Stub>> stubs;
  std::vector<std::unique_ptr<OpenedStream>> greedy;
  for (int i = 0; i < 20; ++i) {
    stubs.push_back(client_with("anna's"));
    greedy.push_back(std::make_unique<OpenedStream>(*stubs.back(), session));
    greedy.back()->ask(1, view_with_formulas(13, 180 + i));  // each takes all the time that a view may
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_views_received_total") == 20; }));
  OpenedStream modest(*bert_, session);
  modest.ask(1, 10);
  EXPECT_EQ(modest.read().error().message(), "");
  EXPECT_LE(metric("curvecast_views_answered_total"), 10) << "they wait for each other";
  // They go, and nothing is made for them any more.
  for (const auto& stream : greedy) stream->context.TryCancel();
  EXPECT_TRUE(eventually([&] { return metric("curvecast_open_streams") == 1; }));
}

}  // namespace
}  // namespace curvecast::server
