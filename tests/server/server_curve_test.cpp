// GetCurve, over TCP.
#include <gmock/gmock.h>

#include <cmath>

#include "core/curve/hilbert.h"
#include "server_fixture.h"
#include "tests/server/convert/values_of.h"

namespace curvecast::server {
namespace {

class ServerCurve : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    std::vector<v1::GetCurveResponse> responses;
  };
  static Answer get(Stub& stub, const std::string& session_id, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetCurveRequest request;
    request.set_session_id(session_id);
    const auto reader = stub.GetCurve(&context, request);
    Answer answer;
    v1::GetCurveResponse response;
    while (reader->Read(&response)) {
      answer.responses.push_back(response);
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }
};

/// All chunks together.
struct Joined {
  std::vector<float> positions, areas;
  std::vector<std::int16_t> normals;
  std::vector<std::uint32_t> cells;
  std::vector<std::uint8_t> levels;

  explicit Joined(const std::vector<v1::GetCurveResponse>& responses) {
    std::string p, a, n, c, l;
    for (const auto& response : responses) {
      p += response.chunk().positions();
      a += response.chunk().areas();
      n += response.chunk().normals();
      c += response.chunk().cells();
      l += response.chunk().levels();
    }
    positions = values_of<float>(p);
    areas = values_of<float>(a);
    normals = values_of<std::int16_t>(n);
    cells = values_of<std::uint32_t>(c);
    levels = values_of<std::uint8_t>(l);
  }
};

TEST_F(ServerCurve, SendsTheWholeCurveInBoundedChunks) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 10'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const Answer answer = get(*stub, created.session.session_id());
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  ASSERT_GE(answer.responses.size(), 4u);
  EXPECT_FALSE(answer.responses[0].has_chunk());
  const v1::CurveInfo& info = answer.responses[0].info();
  EXPECT_EQ(info.curve_vertices(), created.session.report().curve_vertices());
  EXPECT_EQ(info.discs(), created.session.report().discs());
  EXPECT_EQ(info.revision(), created.session.curve_revision());
  std::uint64_t count = 0;
  for (const auto& response : answer.responses) {
    EXPECT_LE(response.ByteSizeLong(), std::size_t{1} << 20);
    count += response.chunk().count();
  }
  ASSERT_EQ(count, info.curve_vertices());
  const Joined curve(answer.responses);
  ASSERT_EQ(curve.positions.size(), 3 * count);
  ASSERT_EQ(curve.normals.size(), 3 * count);
  ASSERT_EQ(curve.areas.size(), count);
  ASSERT_EQ(curve.cells.size(), 2 * count);
  ASSERT_EQ(curve.levels.size(), count);
  double surface = 0, square = 0;
  for (std::size_t l = 0; l < count; ++l) {
    surface += curve.areas[l];
    square += std::ldexp(1.0, -2 * curve.levels[l]);
    const float* p = &curve.positions[3 * l];
    ASSERT_NEAR(std::hypot(p[0], p[1], p[2]), 1, 0.02);
    const std::int16_t* n = &curve.normals[3 * l];
    ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 32767, 2);
    ASSERT_GT((p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / 32767, 0.9);
  }
  EXPECT_NEAR(surface, created.session.report().mesh().area(), 1e-4 * surface);
  EXPECT_NEAR(square, 1, 1e-12);  // the disc fills its square, and so do its quads
  // Consecutive quads share a side, or a part of one.
  for (std::size_t l = 0; l + 1 < count; ++l) {
    const std::uint32_t sides[2] = {1u << (kMaxLevel - curve.levels[l]), 1u << (kMaxLevel - curve.levels[l + 1])};
    int touching = 0, overlapping = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const std::uint32_t a = curve.cells[2 * l + axis], b = curve.cells[2 * (l + 1) + axis];
      touching += a + sides[0] == b || b + sides[1] == a;
      overlapping += a < b + sides[1] && b < a + sides[0];
    }
    ASSERT_EQ(touching, 1) << l;
    ASSERT_EQ(overlapping, 1) << l;
  }
}

TEST_F(ServerCurve, DiscsComeOneAfterTheOther) {
  const auto stub = client();
  // Two triangles apart.
  const std::string mesh = upload(*stub, "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n3 0 1 2\n3 3 4 5\n");
  const Created created = create(*stub, mesh, 100);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const Answer answer = get(*stub, created.session.session_id());
  ASSERT_EQ(answer.responses.size(), 3u);
  EXPECT_EQ(answer.responses[0].info().discs(), 2u);
  for (std::uint32_t d = 0; d < 2; ++d) {
    EXPECT_EQ(answer.responses[1 + d].chunk().disc(), d);
    for (std::size_t l = 0; l < answer.responses[1 + d].chunk().count(); ++l) {
      const auto positions = values_of<float>(answer.responses[1 + d].chunk().positions());
      EXPECT_EQ(positions[3 * l] > 4, d == 1);
    }
  }
}

TEST_F(ServerCurve, EndsWhenTheClientCancels) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 100'000);
  EXPECT_EQ(get(*stub, created.session.session_id(), true).status.error_code(), grpc::CANCELLED);
  EXPECT_TRUE(get(*stub, created.session.session_id()).status.ok());
}

TEST_F(ServerCurve, RefusesUnknownSessions) {
  const auto stub = client();
  EXPECT_EQ(get(*stub, std::string(32, '0')).status.error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(get(*stub, "").status.error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerCurve, IsNotMadeForAView) {
  const auto stub = client();
  const std::string id = upload(*stub, sphere_off(3));
  v1::CreateSessionRequest request;
  request.set_mesh_id(id);
  request.mutable_options()->add_density()->mutable_view();
  grpc::ClientContext context;
  set_patience(context);
  const auto reader = stub->CreateSession(&context, request);
  v1::CreateSessionResponse response;
  while (reader->Read(&response)) {
  }
  const grpc::Status status = reader->Finish();
  EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), ::testing::HasSubstr("options.density[0] depends on a camera"));
}

}  // namespace
}  // namespace curvecast::server
