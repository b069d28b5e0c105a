// Meshes, sessions and point sets, over TCP.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <thread>

#include "eventually.h"
#include "server_fixture.h"

#include "tests/server/convert/values_of.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerSessions : public ServerFixture {};

TEST_F(ServerSessions, UploadsAndInspects) {
  const auto stub = client();
  const std::string bytes = sphere_off(4);
  const std::string id = upload(*stub, bytes);
  EXPECT_EQ(id.size(), 32u);
  EXPECT_EQ(upload(*client(), bytes), id);
  {
    grpc::ClientContext context;
    v1::GetMeshRequest request;
    v1::GetMeshResponse response;
    request.set_mesh_id(id);
    ASSERT_TRUE(stub->GetMesh(&context, request, &response).ok());
    EXPECT_EQ(response.name(), "test.off");
    EXPECT_EQ(response.size(), bytes.size());
  }
  grpc::ClientContext context;
  v1::InspectMeshRequest request;
  v1::InspectMeshResponse response;
  request.set_mesh_id(id);
  const grpc::Status status = stub->InspectMesh(&context, request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.mesh().name(), "test.off");
  EXPECT_EQ(response.mesh().format(), "off");
  EXPECT_EQ(response.mesh().faces(), 2048u);
  EXPECT_EQ(response.mesh().vertices(), 1026u);
  EXPECT_EQ(response.mesh().genus(), 0u);
  EXPECT_NEAR(response.mesh().area(), 12.56, 0.1);
  EXPECT_NEAR(response.mesh().box_max().z(), 1, 1e-6);
}

TEST_F(ServerSessions, RefusesBrokenUploads) {
  start({.max_upload_bytes = 100'000});
  const auto stub = client();
  const std::string bytes(1000, 'x');
  v1::UploadHeader header;
  const auto code = [&](std::uint64_t size, const std::string& id, std::size_t chunk = 10'000) {
    header.set_size(size);
    header.set_mesh_id(id);
    return upload(*stub, header, bytes, chunk).status.error_code();
  };
  EXPECT_EQ(code(0, ""), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(code(999, ""), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(code(1001, ""), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(code(1000, "00112233445566778899aabbccddeeff"), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(code(100'001, ""), grpc::RESOURCE_EXHAUSTED);
  EXPECT_EQ(code(~std::uint64_t{0}, ""), grpc::RESOURCE_EXHAUSTED);
  EXPECT_EQ(code(1000, "", 1), grpc::OK);
  for (const bool with_header : {false, true}) {  // no header, two headers
    grpc::ClientContext context;
    set_patience(context);
    v1::UploadMeshResponse response;
    const auto writer = stub->UploadMesh(&context, &response);
    v1::UploadMeshRequest request;
    if (with_header) {
      request.mutable_header()->set_size(10);
      writer->Write(request);
    } else {
      request.set_chunk("abc");
    }
    writer->Write(request);
    writer->WritesDone();
    EXPECT_EQ(writer->Finish().error_code(), grpc::INVALID_ARGUMENT);
  }
}

TEST_F(ServerSessions, TwoClientsShareOneJob) {
  const std::string id = upload(*client(), sphere_off(4));
  Created first, second;
  std::thread other([&] { first = create(*client(), id, 5000); });
  second = create(*client(), id, 5000);
  other.join();
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  ASSERT_TRUE(second.status.ok()) << second.status.error_message();
  // Its times and memory are the same to the bit: it was made once.
  EXPECT_EQ(first.session.SerializeAsString(), second.session.SerializeAsString());
  EXPECT_EQ(first.session.state(), v1::SESSION_STATE_READY);
  EXPECT_EQ(first.session.mesh_id(), id);
  EXPECT_EQ(first.session.options().max_points(), 5000u);
  EXPECT_EQ(first.session.options().omega(), 10);
  EXPECT_GE(first.session.report().curve_vertices(), 40'000u);
  EXPECT_GT(first.session.report().peak_bytes(), 1'000'000u);
  EXPECT_EQ(first.session.report().flipped_triangles(), 0u);

  const auto stub = client();
  grpc::ClientContext list_context, get_context;
  v1::ListSessionsResponse list;
  ASSERT_TRUE(stub->ListSessions(&list_context, {}, &list).ok());
  ASSERT_EQ(list.sessions_size(), 1);
  v1::GetSessionRequest request;
  request.set_session_id(list.sessions(0).session_id());
  v1::GetSessionResponse got;
  ASSERT_TRUE(stub->GetSession(&get_context, request, &got).ok());
  EXPECT_EQ(got.session().SerializeAsString(), first.session.SerializeAsString());
}

TEST_F(ServerSessions, ProgressGoesThroughTheStages) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 5000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  std::vector<std::string> stages;
  for (const auto& progress : created.progress) {
    EXPECT_GE(progress.fraction(), 0);
    EXPECT_LE(progress.fraction(), 1);
    if (stages.empty() || stages.back() != progress.stage()) stages.push_back(progress.stage());
  }
  EXPECT_EQ(stages.front(), "queued");
  EXPECT_EQ(std::set<std::string>(stages.begin(), stages.end()),
            (std::set<std::string>{"queued", "read", "repair", "cut", "parameterise", "curve", "map", "area", "ranks"}));
}

TEST_F(ServerSessions, ResamplesTheSameBytesEveryTime) {
  start({.max_curve_vertices = 0});  // a refined curve would give others
  const auto first = client(), second = client();
  const Created created = create(*first, upload(*first, sphere_off(4)), 5000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const std::string& id = created.session.session_id();
  v1::SampleRequest sample = view_of(4321);
  const Resampled a = resample(*first, id, sample), b = resample(*second, id, sample);
  ASSERT_TRUE(a.status.ok()) << a.status.error_message();
  EXPECT_EQ(a.points(), 4321u);
  EXPECT_EQ(a.bytes(), b.bytes());
  EXPECT_GT(a.blocks.back().statistics().curve_vertices(), 0u);
  sample.set_seed(1);
  EXPECT_NE(resample(*first, id, sample).bytes(), a.bytes());
}

/// How many of a cube's points have normals of no face.
std::size_t count_leaning(const Resampled& resampled) {
  std::size_t count = 0;
  for (const v1::ResampleResponse& response : resampled.blocks) {
    const auto normals = values_of<std::array<float, 3>>(response.points().raw().normals());
    EXPECT_EQ(normals.size(), response.points().count());
    count += std::ranges::count_if(normals, [](const auto& n) {
      return std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}) < 0.99f;
    });
  }
  return count;
}

TEST_F(ServerSessions, HaveCreasesFromTheAngleThatTheyAskFor) {
  const auto stub = client();
  const std::string cube = upload(*stub, testing::to_off(testing::cube()));
  v1::SessionOptions options;
  options.set_max_points(1000);
  v1::SampleRequest sample;
  sample.set_points(1000);
  sample.mutable_encoding()->mutable_raw();
  std::map<double, std::string> ids;
  for (const double degrees : {0.0, 40.0, 89.0, 91.0, 180.0}) {
    SCOPED_TRACE(degrees);
    options.set_crease_degrees(degrees);
    const Created created = create(*stub, cube, options);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    EXPECT_EQ(created.session.options().crease_degrees(), degrees);
    ids[degrees] = created.session.session_id();
    const Resampled resampled = resample(*stub, ids[degrees], sample);
    ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    if (degrees < 90) {
      EXPECT_EQ(count_leaning(resampled), 0u);
    } else {
      EXPECT_GT(count_leaning(resampled), 500u);
    }
  }
  std::set<std::string> different;
  for (const auto& [degrees, id] : ids) different.insert(id);
  EXPECT_EQ(different.size(), ids.size());
  const Created unset = create(*stub, cube, 1000);
  EXPECT_NE(unset.session.session_id(), ids[40]);
  EXPECT_FALSE(unset.session.options().has_crease_degrees());
  for (const double degrees : {-1.0, 180.5, std::numeric_limits<double>::quiet_NaN()}) {
    options.set_crease_degrees(degrees);
    const grpc::Status refused = create(*stub, cube, options).status;
    EXPECT_EQ(refused.error_code(), grpc::INVALID_ARGUMENT);
    EXPECT_THAT(refused.error_message(), HasSubstr("options.crease_degrees"));
  }
}

TEST_F(ServerSessions, LargePointSetsComeInBlocks) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 150'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  v1::SampleRequest sample;
  sample.set_points(150'000);
  for (const bool raw : {false, true}) {
    if (raw) sample.mutable_encoding()->mutable_raw();
    const Resampled resampled = resample(*stub, created.session.session_id(), sample);
    ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    EXPECT_EQ(resampled.points(), 150'000u);
    ASSERT_EQ(resampled.blocks.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) {
      const auto& block = resampled.blocks[i];
      EXPECT_LT(block.ByteSizeLong(), 4u << 20);
      EXPECT_EQ(block.has_statistics(), i == 11);
      EXPECT_EQ(block.points().raw().positions().size(), raw ? 12u * block.points().count() : 0u);
      EXPECT_EQ(block.points().draco().data().empty(), raw);
    }
  }
}

TEST_F(ServerSessions, BadRequestsAreRefusedAndTheServerGoesOn) {
  const auto stub = client();
  EXPECT_EQ(create(*stub, "nonsense", 100).status.error_code(), grpc::NOT_FOUND);
  const std::string broken = upload(*stub, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n");
  const Created failed = create(*stub, broken, 100);
  EXPECT_EQ(failed.status.error_code(), grpc::INVALID_ARGUMENT) << failed.status.error_message();
  EXPECT_THAT(failed.status.error_message(), HasSubstr("test.off"));

  const std::string mesh = upload(*stub, sphere_off(3));
  EXPECT_EQ(create(*stub, mesh, 5'000'000).status.error_code(), grpc::INVALID_ARGUMENT);
  const Created created = create(*stub, mesh, 1000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const std::string& id = created.session.session_id();
  EXPECT_EQ(resample(*stub, "nonsense", view_of(10)).status.error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(resample(*stub, id, view_of(0)).status.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(resample(*stub, id, view_of(4'000'001)).status.error_code(), grpc::OUT_OF_RANGE);
  v1::SampleRequest sample = view_of(10);
  sample.mutable_cameras(0)->mutable_eye()->set_x(std::numeric_limits<double>::quiet_NaN());
  const grpc::Status refused = resample(*stub, id, sample).status;
  EXPECT_EQ(refused.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(refused.error_message(), HasSubstr("sample.cameras[0].eye.x is not finite"));
  EXPECT_EQ(resample(*stub, id, view_of(10)).points(), 10u);
}

TEST_F(ServerSessions, CloseForgetsASession) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(3)), 1000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  v1::CloseSessionRequest request;
  request.set_session_id(created.session.session_id());
  v1::CloseSessionResponse response;
  grpc::ClientContext first, second;
  EXPECT_TRUE(stub->CloseSession(&first, request, &response).ok());
  EXPECT_EQ(stub->CloseSession(&second, request, &response).error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(resample(*stub, created.session.session_id(), view_of(10)).status.error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerSessions, ASessionThatNobodyWaitsForVanishes) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(6));
  {
    grpc::ClientContext context;
    v1::CreateSessionRequest request;
    request.set_mesh_id(mesh);
    request.mutable_options()->set_max_points(2'000'000);  // far longer than it takes to cancel
    const auto reader = stub->CreateSession(&context, request);
    v1::CreateSessionResponse response;
    ASSERT_TRUE(reader->Read(&response));
    context.TryCancel();
    while (reader->Read(&response)) {
    }
    EXPECT_EQ(reader->Finish().error_code(), grpc::CANCELLED);
  }
  // The server learns of it in its own time, and stops.
  v1::ListSessionsResponse list;
  EXPECT_TRUE(eventually([&] {
    grpc::ClientContext context;
    EXPECT_TRUE(stub->ListSessions(&context, {}, &list).ok());
    return list.sessions_size() == 0 || list.sessions(0).state() == v1::SESSION_STATE_READY;
  }));
  EXPECT_EQ(list.sessions_size(), 0);
  EXPECT_TRUE(create(*stub, mesh, 1000).status.ok());
}

}  // namespace
}  // namespace curvecast::server
