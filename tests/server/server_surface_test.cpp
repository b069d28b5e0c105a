// GetSurface, over TCP.
#include <gmock/gmock.h>

#include <algorithm>

#include "server_fixture.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerSurface : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    v1::SurfaceInfo info;
    std::string file;
    std::size_t largest = 0;  // message, bytes
  };

  static Answer ask(Stub& stub, const std::string& session_id, std::uint32_t position_bits = 0) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSurfaceRequest request;
    request.set_session_id(session_id);
    request.set_position_bits(position_bits);
    const auto reader = stub.GetSurface(&context, request);
    Answer answer;
    v1::GetSurfaceResponse response;
    while (reader->Read(&response)) {
      answer.largest = std::max(answer.largest, response.ByteSizeLong());
      if (response.has_info()) answer.info = response.info();
      answer.file += response.chunk();
    }
    answer.status = reader->Finish();
    return answer;
  }
};

TEST_F(ServerSurface, SendsTheMeshInChunks) {
  const auto stub = client();
  // Vertices that are moved at random, so that a file of fine positions takes several chunks.
  const std::string mesh = testing::to_off(testing::jittered(testing::square(500), 4e-4));
  const Created created = create(*stub, upload(*stub, mesh), 1'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const Answer answer = ask(*stub, created.session.session_id());
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_EQ(answer.info.vertices(), 501u * 501);
  EXPECT_EQ(answer.info.triangles(), 500'000u);
  EXPECT_EQ(answer.info.bytes(), answer.file.size());
  EXPECT_EQ(answer.info.crease_degrees(), 40);
  EXPECT_TRUE(answer.file.starts_with("DRACO"));
  EXPECT_LE(answer.largest, std::size_t{1} << 20);
  // The same bytes again, from where they are kept; finer positions take more.
  EXPECT_EQ(ask(*stub, created.session.session_id()).file, answer.file);
  EXPECT_EQ(ask(*stub, created.session.session_id(), 14).file, answer.file);
  const Answer fine = ask(*stub, created.session.session_id(), 24);
  EXPECT_GT(fine.file.size(), answer.file.size());
  EXPECT_GT(fine.file.size(), fine.largest) << "several chunks";
  EXPECT_LE(fine.largest, std::size_t{1} << 20);
}

TEST_F(ServerSurface, SaysWhatItDoesNotSend) {
  const auto stub = client();
  EXPECT_EQ(ask(*stub, "0123456789abcdef0123456789abcdef").status.error_code(), grpc::StatusCode::NOT_FOUND);
  const Created created = create(*stub, upload(*stub, sphere_off(2)), 1'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  for (const std::uint32_t bits : {1u, 7u, 25u, 4'000'000'000u}) {
    const Answer refused = ask(*stub, created.session.session_id(), bits);
    EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(refused.status.error_message(), HasSubstr("position_bits"));
  }
  EXPECT_TRUE(ask(*stub, created.session.session_id(), 8).status.ok());
  EXPECT_TRUE(ask(*stub, created.session.session_id(), 24).status.ok());
}

}  // namespace
}  // namespace curvecast::server
