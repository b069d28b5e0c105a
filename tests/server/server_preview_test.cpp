// A great mesh, of which there is something to see before it is ready, over TCP.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/pipeline/pipeline.h"
#include "tests/server/server_fixture.h"

namespace curvecast::server {
namespace {

template <typename Value>
void append(std::string& bytes, const Value& value) {
  char raw[sizeof(Value)];
  std::memcpy(raw, &value, sizeof(Value));
  bytes.append(raw, sizeof(Value));
}

/// A wavy square of 2 n^2 triangles as a binary PLY file.
std::string waves_ply(std::uint32_t n) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string((n + 1) * (n + 1)) +
                      "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(2 * n * n) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const float x = static_cast<float>(j) / static_cast<float>(n), y = static_cast<float>(i) / static_cast<float>(n);
      for (const float value : {x, y, 0.1F * std::sin(8 * x) * std::cos(6 * y)}) append(bytes, value);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
      for (const auto& corners : {std::array{a, b, d}, std::array{a, d, c}}) {
        append(bytes, std::uint8_t{3});
        append(bytes, corners);
      }
    }
  }
  return bytes;
}

class ServerPreview : public ServerFixture {
 protected:
  void SetUp() override { start({.max_stall = std::chrono::minutes(10)}); }  // however slowly the mesh comes

  static constexpr std::uint32_t kSide = 720;
  static_assert(std::size_t{2} * kSide * kSide > kMostWithoutPreview);

  /// Uploads a mesh that is large enough; the request for a session of it.
  v1::CreateSessionRequest great_mesh(v1::CurvecastService::StubInterface& stub) {
    v1::UploadHeader header;
    header.set_name("waves.ply");
    const std::string file = waves_ply(kSide);
    header.set_size(file.size());
    const Uploaded uploaded = upload(stub, header, file, std::size_t{1} << 20);
    EXPECT_TRUE(uploaded.status.ok()) << uploaded.status.error_message();
    v1::CreateSessionRequest request;
    request.set_mesh_id(uploaded.response.mesh_id());
    request.mutable_options()->set_max_points(1000);
    return request;
  }
};

TEST_F(ServerPreview, IsNotMadeForClientsThatDoNotWantIt) {
  const auto stub = client();
  v1::CreateSessionRequest request = great_mesh(*stub);
  request.set_without_preview(true);
  grpc::ClientContext context;
  set_patience(context);
  const auto creating = stub->CreateSession(&context, request);
  bool is_ready = false;
  for (v1::CreateSessionResponse response; creating->Read(&response);) {
    EXPECT_FALSE(response.has_preview());
    is_ready = response.has_session();
  }
  EXPECT_TRUE(creating->Finish().ok());
  EXPECT_TRUE(is_ready);
}

TEST_F(ServerPreview, IsShownEarlyAndGivesWayInTheSameStream) {
  const auto stub = client();
  const v1::CreateSessionRequest request = great_mesh(*stub);
  grpc::ClientContext create_context, views_context;
  set_patience(create_context);
  set_patience(views_context);
  const auto creating = stub->CreateSession(&create_context, request);
  std::unique_ptr<grpc::ClientReaderWriterInterface<v1::StreamViewsRequest, v1::StreamViewsResponse>> views;
  v1::Session preview, session;
  v1::StreamViewsResponse first;
  for (v1::CreateSessionResponse response; creating->Read(&response);) {
    if (response.has_session()) session = response.session();
    if (!response.has_preview()) continue;
    EXPECT_EQ(views, nullptr) << "a second preview";
    EXPECT_FALSE(response.has_session());
    preview = response.preview();
    views = stub->StreamViews(&views_context);
    v1::StreamViewsRequest message;
    message.mutable_open()->set_session_id(preview.session_id());
    message.mutable_open()->set_accept_deltas(true);
    ASSERT_TRUE(views->Write(message));
    message.mutable_view()->set_sequence(1);
    message.mutable_view()->mutable_sample()->set_points(500);
    message.mutable_view()->mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
    ASSERT_TRUE(views->Write(message));
    ASSERT_TRUE(views->Read(&first));
  }
  ASSERT_TRUE(creating->Finish().ok());
  ASSERT_NE(views, nullptr) << "no preview";
  EXPECT_EQ(preview.session_id(), session.session_id());
  EXPECT_LT(preview.report().mesh().faces(), 200'000u);
  EXPECT_EQ(session.report().mesh().faces(), std::uint64_t{2} * kSide * kSide);
  EXPECT_NEAR(preview.report().mesh().area(), session.report().mesh().area(), 0.02 * session.report().mesh().area());

  const auto acknowledge = [&] {
    v1::StreamViewsRequest message;
    message.mutable_ack()->set_sequence(1);
    return views->Write(message);
  };
  EXPECT_EQ(first.frame().kind(), v1::FRAME_KIND_KEY);
  EXPECT_TRUE(first.frame().statistics().refining());
  ASSERT_TRUE(acknowledge());
  // Of the preview there may be better frames first.
  v1::StreamViewsResponse last = first;
  while (last.frame().statistics().refining()) {
    ASSERT_TRUE(views->Read(&last));
    ASSERT_FALSE(last.frame().has_error()) << last.frame().error().message();
    ASSERT_TRUE(acknowledge());
  }
  EXPECT_EQ(last.frame().held_points(), 500u);
  views->WritesDone();
  EXPECT_TRUE(views->Finish().ok());
}

}  // namespace
}  // namespace curvecast::server
