// Measure, over TCP.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>

#include "core/base/random.h"
#include "core/base/vec.h"
#include "server_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

/// N random points of the unit sphere, as they are uploaded, moved by -origin.
std::string random_points(std::size_t n, const Vec3d& origin = Vec3d::Zero()) {
  std::string bytes;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 2 * random_unit(n, 2 * i) - 1, angle = 2 * std::acos(-1) * random_unit(n, 2 * i + 1),
                 r = std::sqrt(1 - z * z);
    const Vec3f p = (Vec3d(r * std::cos(angle), r * std::sin(angle), z) - origin).cast<float>();
    bytes.append(reinterpret_cast<const char*>(p.data()), sizeof p);
  }
  return bytes;
}

class ServerMeasure : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    std::vector<v1::Progress> progress;
    v1::Measures measures;
  };
  static Answer measure(Stub& stub, const v1::MeasureRequest& request, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    const auto reader = stub.Measure(&context, request);
    Answer answer;
    v1::MeasureResponse response;
    while (reader->Read(&response)) {
      if (response.has_progress()) answer.progress.push_back(response.progress());
      if (response.has_measures()) answer.measures = response.measures();
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }
  static v1::MeasureRequest request_for(Stub& stub, const std::vector<std::string>& sets) {
    v1::MeasureRequest request;
    request.set_mesh_id(upload(stub, sphere_off(5)));
    for (const std::string& set : sets) request.add_sets()->set_points_id(upload(stub, set));
    return request;
  }
};

TEST_F(ServerMeasure, MeasuresTheDistanceOfAnotherMesh) {
  const auto stub = client();
  v1::MeasureRequest request = request_for(*stub, {});
  request.set_other_mesh_id(upload(*stub, sphere_off(3)));
  request.set_distance_samples(50'000);
  const Answer answer = measure(*stub, request);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_EQ(answer.measures.sets_size(), 0);
  ASSERT_TRUE(answer.measures.has_distance());
  const v1::MeshDistance& distance = answer.measures.distance();
  EXPECT_NEAR(distance.diagonal(), 2 * std::sqrt(3), 0.1);
  EXPECT_EQ(distance.max(), std::max(distance.from_mesh().max(), distance.from_other().max()));
  for (const v1::OneWayDistance& side : {distance.from_mesh(), distance.from_other()}) {
    EXPECT_GT(side.mean(), 0.01);
    EXPECT_GT(side.rms(), side.mean());
    EXPECT_GT(side.max(), side.rms());
    EXPECT_LT(side.max(), 2);
    EXPECT_GT(side.normal_mean(), 0.5);
    EXPECT_GE(side.normal_rms(), side.normal_mean());
  }
  request.add_sets()->set_points_id(upload(*stub, random_points(500)));
  const Answer both = measure(*stub, request);
  EXPECT_EQ(both.measures.sets_size(), 1);
  EXPECT_EQ(both.measures.distance().SerializeAsString(), distance.SerializeAsString());
  EXPECT_EQ(distance.from_mesh().picture_share(), 0);
  v1::Camera& camera = *request.add_cameras();
  camera.mutable_eye()->set_z(10);
  camera.mutable_target();
  const v1::OneWayDistance side = measure(*stub, request).measures.distance().from_mesh();
  EXPECT_NEAR(side.picture_share(), 1, 1e-9);
  // 1,024 pixels over 45 degrees, 9 to 11 units away.
  const double pixels = 512 / std::tan(std::numbers::pi / 8) * side.mean() / 100 * distance.diagonal();
  EXPECT_GT(side.picture_mean(), pixels / 11);
  EXPECT_LT(side.picture_mean(), pixels / 9);
  request.set_distance_samples(7);
  EXPECT_THAT(measure(*stub, request).status.error_message(), HasSubstr("distance_samples is 7"));
  request.set_distance_samples(0);
  request.set_other_mesh_id("nothing");
  EXPECT_EQ(measure(*stub, request).status.error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerMeasure, MeasuresSetsAndTellsHowFarItIs) {
  const auto stub = client();
  v1::MeasureRequest request = request_for(*stub, {random_points(500), random_points(8000)});
  const Answer answer = measure(*stub, request);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  ASSERT_EQ(answer.measures.sets_size(), 2);
  EXPECT_EQ(answer.measures.sets(0).points(), 500u);
  EXPECT_EQ(answer.measures.sets(1).points(), 8000u);
  for (const v1::PointMeasures& set : answer.measures.sets()) {
    EXPECT_LE(set.on_surface().mean(), set.on_surface().max());
    EXPECT_LT(set.on_surface().max(), 0.1);
    for (const v1::Discrepancy& discrepancy : {set.ring_discrepancy(), set.ball_discrepancy()}) {
      EXPECT_GT(discrepancy.max(), discrepancy.rms());
      EXPECT_GT(discrepancy.rms_relative(), 0.4);
      EXPECT_LT(discrepancy.rms_relative(), 2);
    }
    EXPECT_LT(set.spacing().rho(), 0.2);
    EXPECT_GE(set.spacing().rho_same_side(), set.spacing().rho());
    EXPECT_NEAR(set.spacing().nn_mean(), 0.465, 0.05);  // half the root of 1 / density, over 2 r
    EXPECT_GT(set.spacing().coverage(), 2);
  }
  EXPECT_NEAR(answer.measures.gradient().ball_rms(), -0.5, 0.3);
  std::string stages;
  for (const v1::Progress& progress : answer.progress) stages += progress.stage() + " ";
  EXPECT_THAT(stages, ::testing::ContainsRegex("queued.*read.*balls.*points.*rings"));
  // Again, and from elsewhere.
  EXPECT_EQ(measure(*stub, request).measures.SerializeAsString(), answer.measures.SerializeAsString());
  const Vec3d origin(100, 0, -3);
  request.mutable_sets(1)->set_points_id(upload(*stub, random_points(8000, origin)));
  request.mutable_sets(1)->mutable_origin()->set_x(origin.x());
  request.mutable_sets(1)->mutable_origin()->set_z(origin.z());
  EXPECT_NEAR(measure(*stub, request).measures.sets(1).ball_discrepancy().rms(), answer.measures.sets(1).ball_discrepancy().rms(),
              1e-3 * answer.measures.sets(1).ball_discrepancy().rms());
}

TEST_F(ServerMeasure, RefusesWhatCannotBeMeasured) {
  const auto stub = client();
  const v1::MeasureRequest good = request_for(*stub, {random_points(10)});
  using Break = std::function<void(v1::MeasureRequest&)>;
  const auto refused = [&](const Break& change, grpc::StatusCode code, const std::string& words) {
    v1::MeasureRequest request = good;
    change(request);
    const grpc::Status status = measure(*stub, request).status;
    EXPECT_EQ(status.error_code(), code) << words;
    EXPECT_THAT(status.error_message(), HasSubstr(words));
  };
  const auto with_bytes = [&](std::string bytes) -> Break {
    return [&stub, bytes](v1::MeasureRequest& r) { r.mutable_sets(0)->set_points_id(upload(*stub, bytes)); };
  };
  std::string nan = random_points(5);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan.data() + 3 * 12, &bad, sizeof bad);
  refused([](auto& r) { r.set_mesh_id(std::string(32, '0')); }, grpc::NOT_FOUND, "mesh");
  refused([](auto& r) { r.mutable_sets(0)->set_points_id("none"); }, grpc::NOT_FOUND, "none");
  refused([](auto& r) { r.clear_sets(); }, grpc::INVALID_ARGUMENT, "sets has 0 entries");
  refused(
      [](auto& r) {
        while (r.sets_size() < 65) *r.add_sets() = r.sets(0);
      },
      grpc::INVALID_ARGUMENT, "sets has 65 entries");
  refused(with_bytes("seven"), grpc::INVALID_ARGUMENT, "sets[0].points_id names 5 bytes");
  refused(with_bytes(random_points(1)), grpc::INVALID_ARGUMENT, "too few points, 1");
  refused(with_bytes(nan), grpc::INVALID_ARGUMENT, "point 3 of set 0 is not finite");
  refused([](auto& r) { r.mutable_sets(0)->mutable_origin()->set_y(HUGE_VAL); }, grpc::INVALID_ARGUMENT, "sets[0].origin.y");
  refused([](auto& r) { r.mutable_sets(0)->mutable_origin()->set_y(1e200); }, grpc::INVALID_ARGUMENT, "farther from the mesh");
  refused([](auto& r) { r.set_ring_seeds(100'001); }, grpc::INVALID_ARGUMENT, "ring_seeds is 100001");
  refused([](auto& r) { r.set_ball_centres(100'001); }, grpc::INVALID_ARGUMENT, "ball_centres is 100001");
  refused([](auto& r) { r.add_density()->mutable_view(); }, grpc::INVALID_ARGUMENT, "camera");
  refused([](auto& r) { r.add_density(); }, grpc::INVALID_ARGUMENT, "density[0] holds no term");
  refused([&](auto& r) { r.set_mesh_id(upload(*stub, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")); }, grpc::INVALID_ARGUMENT,
          "");
  EXPECT_TRUE(measure(*stub, good).status.ok());
}

TEST_F(ServerMeasure, TakesADensityWithItsCamera) {
  const auto stub = client();
  v1::MeasureRequest request = request_for(*stub, {random_points(4000)});
  const double even = measure(*stub, request).measures.sets(0).ball_discrepancy().rms();
  request.add_density()->mutable_view();
  request.add_cameras()->mutable_eye()->set_z(3);
  const Answer answer = measure(*stub, request);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_GT(answer.measures.sets(0).ball_discrepancy().rms(), 5 * even);  // half of the points are where none should be
}

TEST_F(ServerMeasure, EndsWhenTheClientCancels) {
  const auto stub = client();
  v1::MeasureRequest request = request_for(*stub, {random_points(1000)});
  request.set_ring_seeds(100'000);
  EXPECT_EQ(measure(*stub, request, true).status.error_code(), grpc::CANCELLED);
  request.set_ring_seeds(10);
  EXPECT_TRUE(measure(*stub, request).status.ok());
}

}  // namespace
}  // namespace curvecast::server
