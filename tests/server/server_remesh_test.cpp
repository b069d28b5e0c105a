// Remesh, over TCP.
#include <gmock/gmock.h>

#include <cstring>
#include <set>

#include "core/mesh/pair_halfedges.h"
#include "server_fixture.h"

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
