// Remesh, over TCP.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

#include "core/mesh/pair_halfedges.h"
#include "server_fixture.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerRemesh : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    v1::RemeshInfo info;
    std::string positions, normals, triangles, faces, barycentric;
    std::set<std::string> stages;
    std::size_t largest = 0;  // message, bytes
  };

  static v1::RemeshRequest request(const std::string& session_id, std::uint64_t points) {
    v1::RemeshRequest request;
    request.set_session_id(session_id);
    request.mutable_sample()->set_points(points);
    request.mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
    return request;
  }

  static Answer ask(Stub& stub, const v1::RemeshRequest& request, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    const auto reader = stub.Remesh(&context, request);
    Answer answer;
    v1::RemeshResponse response;
    while (reader->Read(&response)) {
      answer.largest = std::max(answer.largest, response.ByteSizeLong());
      if (response.has_progress()) answer.stages.insert(response.progress().stage());
      if (response.has_info()) answer.info = response.info();
      answer.positions += response.chunk().vertices().raw().positions();
      answer.normals += response.chunk().vertices().raw().normals();
      answer.faces += response.chunk().vertices().attributes().faces();
      answer.barycentric += response.chunk().vertices().attributes().barycentric();
      answer.triangles += response.chunk().triangles();
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }
};

TEST_F(ServerRemesh, SendsAClosedMeshOfSoManyVertices) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 10'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  for (const std::uint64_t n : {500u, 40'000u}) {
    const Answer answer = ask(*stub, request(created.session.session_id(), n));
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_EQ(answer.info.vertices(), n);
    EXPECT_EQ(answer.info.triangles(), 2 * n - 4);
    EXPECT_EQ(answer.info.components(), 1u);
    EXPECT_EQ(answer.info.genus(), 0u);
    EXPECT_EQ(answer.info.boundary_loops(), 0u);
    EXPECT_LE(answer.largest, std::size_t{1} << 20);
    EXPECT_EQ(answer.positions.size(), 12 * n);
    EXPECT_EQ(answer.normals.size(), 12 * n);
    EXPECT_EQ(answer.faces.size(), 4 * n);
    EXPECT_EQ(answer.barycentric.size(), 8 * n);
    EXPECT_TRUE(answer.stages.contains("triangulate"));
    std::vector<Triangle> triangles(answer.info.triangles());
    ASSERT_EQ(answer.triangles.size(), triangles.size() * sizeof(Triangle));
    std::memcpy(triangles.data(), answer.triangles.data(), answer.triangles.size());
    for (const Triangle& t : triangles) ASSERT_TRUE(t[0] < n && t[1] < n && t[2] < n);
    const HalfedgePairs pairs = pair_halfedges(triangles, n);
    EXPECT_TRUE(pairs.border.empty() && pairs.nonmanifold_edges == 0 && pairs.is_oriented);
    // All on the unit sphere's facets, with normals that look outwards.
    std::vector<std::array<float, 3>> positions(n), normals(n);
    std::memcpy(positions.data(), answer.positions.data(), answer.positions.size());
    std::memcpy(normals.data(), answer.normals.data(), answer.normals.size());
    for (std::size_t v = 0; v < n; ++v) {
      const Vec3f p(positions[v][0], positions[v][1], positions[v][2]), normal(normals[v][0], normals[v][1], normals[v][2]);
      ASSERT_NEAR(p.norm(), 1, 0.02);
      ASSERT_GT(p.dot(normal), 0.9);
    }
  }
}

TEST_F(ServerRemesh, GivesTheSameBytesEveryTimeForBothSamplers) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(3)), 10'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  for (const v1::Sampler sampler : {v1::SAMPLER_EQUALISED, v1::SAMPLER_PROGRESSIVE}) {
    v1::RemeshRequest wanted = request(created.session.session_id(), 2'000);
    wanted.mutable_sample()->set_sampler(sampler);
    wanted.mutable_sample()->add_density()->mutable_expression()->set_text("1 + 9 * (z > 0)");
    const Answer one = ask(*stub, wanted), other = ask(*stub, wanted);
    ASSERT_TRUE(one.status.ok()) << one.status.error_message();
    EXPECT_EQ(one.info.vertices(), 2'000u);
    EXPECT_EQ(one.positions, other.positions);
    EXPECT_EQ(one.triangles, other.triangles);
    wanted.set_relaxations(0);
    const Answer raw = ask(*stub, wanted);
    EXPECT_EQ(raw.info.triangles(), one.info.triangles());
    EXPECT_NE(raw.positions, one.positions);
  }
}

TEST_F(ServerRemesh, FitsAndKeepsFeatures) {
  const auto stub = client();
  const Created ball = create(*stub, upload(*stub, sphere_off(4)), 10'000);
  ASSERT_TRUE(ball.status.ok()) << ball.status.error_message();
  v1::RemeshRequest wanted = request(ball.session.session_id(), 500);
  const Answer on_surface = ask(*stub, wanted);
  wanted.set_fit(true);
  const Answer fitted = ask(*stub, wanted);
  ASSERT_TRUE(fitted.status.ok()) << fitted.status.error_message();
  EXPECT_TRUE(fitted.stages.contains("fit"));
  EXPECT_EQ(fitted.triangles, on_surface.triangles);
  EXPECT_NE(fitted.positions, on_surface.positions);
  EXPECT_GT(fitted.info.angles().median(), 45);
  EXPECT_GE(fitted.info.angles().least(), 20);
  EXPECT_EQ(fitted.info.angles().below_20(), 0);
  EXPECT_GT(on_surface.info.angles().percentile_1(), 30);
  wanted.set_fit(false);
  wanted.set_method(v1::REMESH_METHOD_PARAMETER);
  const Answer square = ask(*stub, wanted);
  ASSERT_TRUE(square.status.ok()) << square.status.error_message();
  EXPECT_EQ(square.info.triangles(), 996u);
  // The eight corners of a cube are vertices where its edges stay.
  const Created cube = create(*stub, upload(*stub, curvecast::testing::to_off(curvecast::testing::cube())), 10'000);
  ASSERT_TRUE(cube.status.ok()) << cube.status.error_message();
  wanted = request(cube.session.session_id(), 500);
  const auto corners_of = [](const Answer& answer) {
    std::vector<std::array<float, 3>> positions(answer.info.vertices());
    std::memcpy(positions.data(), answer.positions.data(), answer.positions.size());
    std::array<float, 3> low = positions[0], high = low;
    for (const auto& p : positions) {
      for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    }
    return std::count_if(positions.begin(), positions.end(), [&](const auto& p) {
      const auto at_end = [&](std::size_t i) { return std::min(p[i] - low[i], high[i] - p[i]) < 1e-5f * (high[i] - low[i]); };
      return at_end(0) && at_end(1) && at_end(2);
    });
  };
  wanted.set_feature_degrees(45);
  const Answer sharp = ask(*stub, wanted);
  ASSERT_TRUE(sharp.status.ok()) << sharp.status.error_message();
  EXPECT_EQ(corners_of(sharp), 8);
  wanted.set_feature_degrees(0);
  EXPECT_LT(corners_of(ask(*stub, wanted)), 8);
}

TEST_F(ServerRemesh, SaysWhatItCannotDo) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(3)), 10'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const std::string& id = created.session.session_id();
  EXPECT_EQ(ask(*stub, request("no session", 100)).status.error_code(), grpc::NOT_FOUND);
  const auto expect_refused = [&](const v1::RemeshRequest& bad, const std::string& why) {
    const grpc::Status status = ask(*stub, bad).status;
    EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT) << why;
    EXPECT_THAT(status.error_message(), HasSubstr(why));
  };
  v1::RemeshRequest bad = request(id, 100);
  bad.set_relaxations(101);
  expect_refused(bad, "relaxations is 101");
  bad = request(id, 100);
  bad.set_method(static_cast<v1::RemeshMethod>(7));
  expect_refused(bad, "method is 7");
  bad.set_method(v1::REMESH_METHOD_PARAMETER);
  bad.set_feature_degrees(30);
  expect_refused(bad, "feature_degrees is 30");
  bad = request(id, 100);
  bad.set_feature_degrees(-1);
  expect_refused(bad, "feature_degrees is -1");
  expect_refused(request(id, 3), "3 vertices are too few for a surface of 1 component, genus 0, 0 borders: it takes about 4");
  bad = request(id, 100);
  bad.mutable_sample()->set_max_bytes(100'000);
  expect_refused(bad, "sample has a budget");
  bad.mutable_sample()->mutable_automatic();
  expect_refused(bad, "sample");
  bad = request(id, 100);
  bad.mutable_sample()->add_density()->mutable_expression()->set_text("0");
  EXPECT_EQ(ask(*stub, bad).status.error_code(), grpc::FAILED_PRECONDITION);
}

TEST_F(ServerRemesh, ClientsMayGo) {
  const auto stub = client();
  const Created created = create(*stub, upload(*stub, sphere_off(4)), 10'000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const Answer answer = ask(*stub, request(created.session.session_id(), 200'000), true);
  EXPECT_EQ(answer.status.error_code(), grpc::CANCELLED);
  EXPECT_TRUE(ask(*stub, request(created.session.session_id(), 100)).status.ok());
}

}  // namespace
}  // namespace curvecast::server
