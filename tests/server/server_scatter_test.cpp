// Scatter, over TCP.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server_fixture.h"

#include "core/base/vec.h"
#include "tests/server/convert/values_of.h"

namespace curvecast::server {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using Point = std::array<float, 3>;

class ServerScatter : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    std::string kinds;  // of messages that are not progress, in order: m, p
    std::set<std::string> stages;
    v1::MeshInfo mesh;
    std::vector<v1::PointBlock> blocks;
    std::vector<v1::FrameStatistics> statistics;

    std::size_t points() const {
      std::size_t sum = 0;
      for (const v1::PointBlock& block : blocks) sum += block.count();
      return sum;
    }
    std::string positions() const {
      std::string all;
      for (const v1::PointBlock& block : blocks) all += block.raw().positions();
      return all;
    }
  };

  static v1::ScatterRequest request(const std::string& mesh_id, std::uint64_t points) {
    v1::ScatterRequest request;
    request.set_mesh_id(mesh_id);
    request.mutable_sample()->set_points(points);
    request.mutable_sample()->mutable_encoding()->mutable_raw();
    return request;
  }

  static Answer ask(Stub& stub, const v1::ScatterRequest& request, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    const auto reader = stub.Scatter(&context, request);
    Answer answer;
    for (v1::ScatterResponse response; reader->Read(&response);) {
      if (response.has_progress()) answer.stages.insert(response.progress().stage());
      if (response.has_mesh()) answer.mesh = response.mesh();
      if (!response.has_progress()) answer.kinds += response.has_mesh() ? 'm' : 'p';
      if (response.has_points()) {
        answer.blocks.push_back(response.points().points());
        if (response.points().has_statistics()) answer.statistics.push_back(response.points().statistics());
      }
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }

  /// The error, of which the code is checked.
  static std::string error_of(Stub& stub, const v1::ScatterRequest& request, grpc::StatusCode code) {
    const grpc::Status status = ask(stub, request).status;
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    return status.error_message();
  }
};

TEST_F(ServerScatter, SendsExactlySoManyPointsOnTheMesh) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(4));
  for (const std::uint64_t points : {1u, 777u, 30'000u}) {
    const Answer answer = ask(*stub, request(mesh, points));
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_EQ(answer.points(), points);
    EXPECT_EQ(answer.kinds, absl::StrCat("m", std::string(answer.blocks.size(), 'p'))) << "first what the file holds";
    EXPECT_EQ(answer.mesh.faces(), 2048u);
    ASSERT_EQ(answer.statistics.size(), 1u);
    EXPECT_EQ(answer.statistics[0].wanted_points(), points);
    EXPECT_FALSE(answer.statistics[0].refining());
    for (const v1::PointBlock& block : answer.blocks) EXPECT_LE(block.count(), 12'500u);
    Vec3d sum = Vec3d::Zero();
    for (const Point& p : values_of<Point>(answer.positions())) {
      const v1::Vec3& origin = answer.blocks[0].origin();
      const Vec3d position(p[0] + origin.x(), p[1] + origin.y(), p[2] + origin.z());
      EXPECT_NEAR(position.norm(), 1, 0.02);
      sum += position;
    }
    if (points == 30'000) {
      EXPECT_LT(sum.norm() / 30'000, 2e-3);
    }
  }
}

TEST_F(ServerScatter, TellsHowFarItIs) {
  const auto stub = client();
  v1::ScatterRequest wanted = request(upload(*stub, sphere_off(5)), 50'000);
  wanted.mutable_sample()->set_relaxation_rounds(3);
  const Answer answer = ask(*stub, wanted);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_THAT(answer.stages, Contains("relax"));
  for (const std::string& stage : answer.stages) {
    EXPECT_THAT((std::set<std::string>{"queued", "read", "repair", "scatter", "relax", "order"}), Contains(stage));
  }
}

TEST_F(ServerScatter, TheSameRequestGetsTheSamePoints) {
  const auto stub = client();
  v1::ScatterRequest wanted = request(upload(*stub, sphere_off(3)), 5000);
  wanted.mutable_sample()->set_relaxation_rounds(1);
  wanted.mutable_sample()->set_seed(5);
  wanted.mutable_sample()->add_density()->mutable_expression()->set_text("z > 0");
  const std::string positions = ask(*stub, wanted).positions();
  std::vector<std::string> others(4);
  std::vector<std::thread> threads;
  for (std::string& other : others) {
    threads.emplace_back([&] { other = ask(*client(), wanted).positions(); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& other : others) EXPECT_EQ(other, positions);
  start({.threads = 1});
  const auto again = client();
  EXPECT_EQ(upload(*again, sphere_off(3)), wanted.mesh_id());
  EXPECT_EQ(ask(*again, wanted).positions(), positions);
  const auto z = [&](const Point& p) { return p[2]; };
  const auto points = values_of<Point>(positions);
  EXPECT_GT(z(*std::min_element(points.begin(), points.end(), [&](auto& a, auto& b) { return z(a) < z(b); })), -0.1);
  wanted.mutable_sample()->set_seed(6);
  EXPECT_NE(ask(*again, wanted).positions(), positions);
}

TEST_F(ServerScatter, BlocksOfDracoShareALattice) {
  const auto stub = client();
  v1::ScatterRequest wanted = request(upload(*stub, sphere_off(4)), 30'000);
  wanted.mutable_sample()->mutable_encoding()->mutable_draco()->set_position_bits(11);
  const Answer answer = ask(*stub, wanted);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_EQ(answer.points(), 30'000u);
  std::size_t bytes = 0;
  for (const v1::PointBlock& block : answer.blocks) bytes += block.draco().data().size();
  EXPECT_GT(bytes, 30'000u);
  EXPECT_LT(bytes, 6 * 30'000u) << "they are in the order of a curve";
}

TEST_F(ServerScatter, SendsWhatElseIsWanted) {
  const auto stub = client();
  v1::ScatterRequest wanted = request(upload(*stub, sphere_off(3)), 2000);
  for (const v1::PointAttribute attribute :
       {v1::POINT_ATTRIBUTE_CURVATURES, v1::POINT_ATTRIBUTE_RANK, v1::POINT_ATTRIBUTE_SURFACE, v1::POINT_ATTRIBUTE_DIRECTIONS,
        v1::POINT_ATTRIBUTE_SCALARS}) {
    wanted.mutable_sample()->add_attributes(attribute);
  }
  const Answer answer = ask(*stub, wanted);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  ASSERT_EQ(answer.blocks.size(), 1u);
  const v1::PointAttributes& attributes = answer.blocks[0].attributes();
  const auto faces = values_of<std::uint32_t>(attributes.faces());
  ASSERT_EQ(faces.size(), 2000u);
  EXPECT_EQ(std::set<std::uint32_t>(faces.begin(), faces.end()).size(), 512u) << "each has its share, of four or so";
  EXPECT_EQ(attributes.barycentric().size(), 2000u * 8);
  auto ranks = values_of<std::uint32_t>(attributes.ranks());
  std::sort(ranks.begin(), ranks.end());
  for (std::uint32_t i = 0; i < 2000; ++i) ASSERT_EQ(ranks.at(i), i);
  EXPECT_EQ(attributes.directions().size(), 2000u * 12);
  for (const float curvature : values_of<float>(attributes.curvatures())) EXPECT_NEAR(curvature, 1, 0.15);
  EXPECT_EQ(attributes.scalars_size(), 0) << "the file has none";
}

TEST_F(ServerScatter, CreasesAreWhereTheRequestSays) {
  const auto stub = client();
  const std::string cube =
      "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 "
      "5\n"
      "4 0 4 7 3\n";
  v1::ScatterRequest wanted = request(upload(*stub, cube), 1000);
  const auto upright = [&] {
    std::ptrdiff_t count = 0;
    for (const v1::PointBlock& block : ask(*stub, wanted).blocks) {
      for (const Point& n : values_of<Point>(block.raw().normals())) {
        count += std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}) > 0.9999f ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(upright(), 1000);
  wanted.set_crease_degrees(180);
  EXPECT_LT(upright(), 50);
}

TEST_F(ServerScatter, SaysWhatIsWrong) {
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(2));
  error_of(*stub, request(std::string(32, '0'), 10), grpc::NOT_FOUND);
  EXPECT_THAT(error_of(*stub, request(mesh, 0), grpc::INVALID_ARGUMENT), HasSubstr("points"));
  error_of(*stub, request(mesh, 4'000'001), grpc::OUT_OF_RANGE);
  EXPECT_THAT(error_of(*stub, request(upload(*stub, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), 10), grpc::INVALID_ARGUMENT),
              HasSubstr("7"));
  const auto changed = [&](const auto& change) {
    v1::ScatterRequest other = request(mesh, 10);
    change(other, *other.mutable_sample());
    return other;
  };
  const auto wrong = [&](const auto& change) { return error_of(*stub, changed(change), grpc::INVALID_ARGUMENT); };
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.clear_points(); }), HasSubstr("how many points"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.set_max_bytes(5000); }), HasSubstr("by their number"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.set_sampler(v1::SAMPLER_PROGRESSIVE); }), HasSubstr("fixed ranks"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.set_sequence(v1::SEQUENCE_GOLDEN_RATIO); }), HasSubstr("equal steps"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.add_attributes(v1::POINT_ATTRIBUTE_UNSPECIFIED); }),
              HasSubstr("attributes"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.set_relaxation_rounds(101); }), HasSubstr("relaxation_rounds"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.add_density()->mutable_frustum(); }), HasSubstr("camera"));
  EXPECT_THAT(wrong([](auto&, auto& sample) { sample.add_density()->mutable_attribute()->set_name("weight"); }),
              HasSubstr("weight"));
  EXPECT_THAT(wrong([](auto& all, auto&) { all.set_crease_degrees(200); }), HasSubstr("crease_degrees is 200"));
  const auto nowhere = changed([](auto&, auto& sample) { sample.add_density()->mutable_expression()->set_text("0"); });
  EXPECT_THAT(error_of(*stub, nowhere, grpc::FAILED_PRECONDITION), HasSubstr("zero"));
  EXPECT_TRUE(ask(*stub, request(mesh, 10)).status.ok());
}

TEST_F(ServerScatter, EndsWhenTheClientCancels) {
  const auto stub = client();
  v1::ScatterRequest wanted = request(upload(*stub, sphere_off(6)), 1'000'000);
  wanted.mutable_sample()->set_relaxation_rounds(100);
  EXPECT_EQ(ask(*stub, wanted, true).status.error_code(), grpc::CANCELLED);
  EXPECT_TRUE(ask(*stub, request(wanted.mesh_id(), 10)).status.ok());
}

TEST_F(ServerScatter, MemoryIsAskedForFirst) {
  start({.memory_bytes = 64 << 20});
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(2));
  EXPECT_THAT(error_of(*stub, request(mesh, 4'000'000), grpc::RESOURCE_EXHAUSTED), HasSubstr("memory"));
  EXPECT_TRUE(ask(*stub, request(mesh, 1000)).status.ok());
}

}  // namespace
}  // namespace curvecast::server
