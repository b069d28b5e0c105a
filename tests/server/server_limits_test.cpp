// What a server refuses, and what it does for whom it has to keep waiting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>
#include <vector>

#include "curvecast/v1/status.pb.h"
#include "server/base/hash.h"
#include "tests/server/eventually.h"
#include "tests/server/frame/frame_points.h"
#include "tests/server/opened_stream.h"
#include "tests/server/server_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerLimits : public ServerFixture {
 protected:
  std::string make_session() {
    const auto stub = client();
    return create(*stub, upload(*stub, sphere_off(3)), 2000).session.session_id();
  }
};

double retry_after(const grpc::Status& status) {
  v1::Status rich;
  v1::RetryInfo retry;
  if (!rich.ParseFromString(status.error_details()) || rich.details().empty()) return 0;
  retry.ParseFromString(rich.details(0).value());
  return static_cast<double>(retry.retry_delay().seconds());
}

TEST_F(ServerLimits, TooManyStreamsAreRefusedAndThereIsRoomAgain) {
  start({.max_streams = 3});
  const std::string session = make_session();
  const auto stub = client();
  std::vector<std::unique_ptr<OpenedStream>> streams;
  v1::StreamViewsResponse response;
  for (int i = 0; i < 3; ++i) {
    streams.push_back(std::make_unique<OpenedStream>(*stub, session));
    ASSERT_TRUE(streams.back()->ask(1, 10));
    ASSERT_TRUE(streams.back()->stream->Read(&response));
  }
  OpenedStream refused(*stub, session);
  EXPECT_FALSE(refused.stream->Read(&response));
  const grpc::Status status = refused.stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("streams"));
  EXPECT_GE(retry_after(status), 1);
  streams[0]->stream->WritesDone();
  EXPECT_TRUE(streams[0]->stream->Finish().ok());
  OpenedStream again(*stub, session);
  again.ask(1, 10);
  EXPECT_TRUE(again.stream->Read(&response));
}

TEST_F(ServerLimits, WhoHasHeardTheEndMayBeginAgain) {
  start({.max_streams_of_client = 1, .max_uploads_of_client = 1});
  const std::string session = make_session();
  const auto stub = client();
  v1::UploadHeader header;
  header.set_size(6);
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(upload(*stub, header, "a file").status.error_message(), "");
    OpenedStream opened(*stub, session);
    opened.stream->WritesDone();
    ASSERT_EQ(opened.stream->Finish().error_message(), "");
  }
}

TEST_F(ServerLimits, AClientHasItsOwnShare) {
  start({.max_streams_of_client = 1, .max_uploads_of_client = 1});
  const std::string session = make_session();
  const auto stub = client();
  v1::StreamViewsResponse response;
  OpenedStream first(*stub, session);
  ASSERT_TRUE(first.ask(1, 10));
  ASSERT_TRUE(first.stream->Read(&response));
  OpenedStream second(*client(), session);
  EXPECT_FALSE(second.stream->Read(&response));
  EXPECT_EQ(second.stream->Finish().error_code(), grpc::RESOURCE_EXHAUSTED);
}

TEST_F(ServerLimits, AFloodOfViewsIsSlowedDownAndTheNewestAnswered) {
  start({.max_view_rate = 50});
  const std::string session = make_session();
  const auto stub = client();
  OpenedStream flood(*stub, session);
  constexpr std::uint64_t kViews = 150;
  const auto begin = std::chrono::steady_clock::now();
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kViews; ++i) flood.ask(i, 10 + i);
  });
  v1::StreamViewsResponse response;
  std::uint64_t frames = 0;
  do {
    ASSERT_TRUE(flood.stream->Read(&response));
    ++frames;
    ASSERT_TRUE(response.frame().error().message().empty()) << response.frame().error().message();
    flood.acknowledge(response.frame().sequence());
  } while (response.frame().sequence() < kViews);
  writer.join();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(count_points(response.frame()), 10 + kViews);
  EXPECT_GE(seconds, (kViews - 50) / 50.0) << "no sooner than the rate allows";
  EXPECT_LE(frames, kViews);
  flood.stream->WritesDone();
  EXPECT_TRUE(flood.stream->Finish().ok());
}

TEST_F(ServerLimits, PointSetsThatNobodyReadsDoNotPileUp) {
  start({.max_queued_bytes = 100'000, .admin = "127.0.0.1:0"});
  const std::string session = make_session();
  const auto stub = client();
  v1::ResampleRequest request;
  request.set_session_id(session);
  request.mutable_sample()->set_points(400'000);
  request.mutable_sample()->mutable_encoding()->mutable_raw();
  grpc::ClientContext context;
  set_patience(context);
  // 13 MB in blocks of 400 KB, of which the connection takes but a few as long as nobody reads them.
  const auto lazy = stub->Resample(&context, request);
  EXPECT_TRUE(eventually([&] { return metric("curvecast_refused_total{limit=\"queued_bytes\"}") == 1; }));
  v1::ResampleResponse block;
  while (lazy->Read(&block)) {
  }
  EXPECT_EQ(lazy->Finish().error_code(), grpc::RESOURCE_EXHAUSTED);
  // It has ended, and there is room again.
  request.mutable_sample()->set_points(1000);
  EXPECT_TRUE(resample(*stub, session, request.sample()).status.ok());
}

TEST_F(ServerLimits, AnUploadGoesOnWhereItBrokeOff) {
  start({.http = "127.0.0.1:0"});
  const std::string bytes = sphere_off(5);
  Hasher hasher;
  hasher.update(bytes);
  const auto stub = client();
  const auto received = [&] {
    grpc::ClientContext context;
    v1::GetUploadRequest request;
    request.set_mesh_id(hasher.hex());
    v1::GetUploadResponse response;
    EXPECT_TRUE(stub->GetUpload(&context, request, &response).ok());
    return response.received();
  };
  v1::UploadHeader header;
  header.set_name("ball.off");
  header.set_size(bytes.size());
  header.set_mesh_id(hasher.hex());
  {
    grpc::ClientContext context;
    v1::UploadMeshResponse response;
    const auto writer = stub->UploadMesh(&context, &response);
    v1::UploadMeshRequest request;
    *request.mutable_header() = header;
    writer->Write(request);
    request.set_chunk(bytes.substr(0, 12'345));
    writer->Write(request);
    // The server has room for it when it has come; until then it is on its way.
    ASSERT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") > 12'345; }));
    context.TryCancel();
    EXPECT_FALSE(writer->Finish().ok());
  }
  // What had come when the client went is kept, once the server has noticed that it went.
  ASSERT_TRUE(eventually([&] { return received() > 0; }));
  const std::uint64_t there = received();
  EXPECT_EQ(there, 12'345u);
  header.set_offset(there + 1);
  EXPECT_EQ(upload(*stub, header, bytes.substr(there)).status.error_code(), grpc::FAILED_PRECONDITION);
  header.set_offset(there);
  const Uploaded whole = upload(*stub, header, bytes.substr(there));
  ASSERT_TRUE(whole.status.ok()) << whole.status.error_message();
  EXPECT_EQ(whole.response.mesh_id(), hasher.hex());
  EXPECT_EQ(received(), 0u);
}

TEST_F(ServerLimits, MeshesOfTheServersOwnFolder) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "ball.off") << sphere_off(3);
  start({.mesh_folder = folder.path()});
  const auto stub = client();
  const auto import = [&](const std::string& path, v1::ImportMeshResponse* response) {
    grpc::ClientContext context;
    v1::ImportMeshRequest request;
    request.set_path(path);
    return stub->ImportMesh(&context, request, response).error_code();
  };
  v1::ImportMeshResponse response;
  EXPECT_EQ(import("ball.off", &response), grpc::OK);
  EXPECT_TRUE(create(*stub, response.mesh_id(), 1000).status.ok());
  EXPECT_EQ(import("../ball.off", &response), grpc::PERMISSION_DENIED);
  EXPECT_EQ(import("none.off", &response), grpc::NOT_FOUND);
  start({});
  const auto other = client();
  grpc::ClientContext context;
  EXPECT_EQ(other->ImportMesh(&context, {}, &response).error_code(), grpc::PERMISSION_DENIED);
}

TEST_F(ServerLimits, SessionsArePinnedAndListedInPages) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(2));
  std::vector<std::string> ids;
  for (const std::uint64_t points : {100u, 200u, 300u}) ids.push_back(create(*stub, mesh, points).session.session_id());
  std::ranges::sort(ids);
  v1::UpdateSessionRequest update;
  update.set_session_id(ids[1]);
  update.set_pinned(true);
  update.set_time_to_live(3600);
  const auto send = [&] {
    grpc::ClientContext context;
    v1::UpdateSessionResponse response;
    const grpc::Status status = stub->UpdateSession(&context, update, &response);
    return std::pair(status.error_code(), response.session());
  };
  const auto [code, session] = send();
  ASSERT_EQ(code, grpc::OK);
  EXPECT_TRUE(session.pinned());
  EXPECT_EQ(session.time_to_live(), 3600);
  EXPECT_GT(session.memory_bytes(), 1000u);
  update.clear_pinned();
  update.set_time_to_live(-1);
  EXPECT_EQ(send().first, grpc::INVALID_ARGUMENT);
  update.clear_time_to_live();
  EXPECT_TRUE(send().second.pinned()) << "what is left out stays";
  update.set_session_id("nonsense");
  EXPECT_EQ(send().first, grpc::NOT_FOUND);

  v1::ListSessionsRequest request;
  request.set_page_size(2);
  std::vector<std::string> listed;
  do {
    grpc::ClientContext context;
    v1::ListSessionsResponse page;
    ASSERT_TRUE(stub->ListSessions(&context, request, &page).ok());
    ASSERT_LE(page.sessions_size(), 2);
    for (const v1::Session& one : page.sessions()) listed.push_back(one.session_id());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, ids);
  request.set_page_token("nonsense");
  grpc::ClientContext context;
  v1::ListSessionsResponse page;
  EXPECT_EQ(stub->ListSessions(&context, request, &page).error_code(), grpc::INVALID_ARGUMENT);
}

TEST_F(ServerLimits, BadFieldsAreNamedForPrograms) {
  const std::string session = make_session();
  v1::SampleRequest sample = view_of(10);
  sample.mutable_cameras(0)->mutable_eye()->set_x(std::numeric_limits<double>::quiet_NaN());
  const Resampled refused = resample(*client(), session, sample);
  ASSERT_EQ(refused.status.error_code(), grpc::INVALID_ARGUMENT);
  v1::Status rich;
  v1::BadRequest bad;
  ASSERT_TRUE(rich.ParseFromString(refused.status.error_details()));
  ASSERT_EQ(rich.details_size(), 1);
  ASSERT_TRUE(bad.ParseFromString(rich.details(0).value()));
  EXPECT_THAT(bad.field_violations(0).field(), HasSubstr("eye"));
}

}  // namespace
}  // namespace curvecast::server
