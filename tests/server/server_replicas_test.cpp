// Servers that have seen different things give the same ranked points.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "server_fixture.h"

#include "tests/server/eventually.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kPoints = 3000;

/// A view of the unit sphere from a distance above the place that faces a direction.
v1::SampleRequest ranked_view(double x, double y, double z, double distance) {
  v1::SampleRequest sample;
  sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
  sample.set_points(kPoints);
  sample.mutable_encoding()->mutable_raw();
  sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  sample.add_attributes(v1::POINT_ATTRIBUTE_SURFACE);
  sample.add_density()->mutable_screen();
  sample.add_density()->mutable_frustum();
  v1::Camera& camera = *sample.add_cameras();
  const double length = std::hypot(x, y, z), scale = (1 + distance) / length;
  camera.mutable_eye()->set_x(scale * x);
  camera.mutable_eye()->set_y(scale * y);
  camera.mutable_eye()->set_z(scale * z);
  return sample;
}

/// So many points of the other sampler that the curve is refined for them.
v1::SampleRequest refining_view() {
  v1::SampleRequest sample;
  sample.set_points(50'000);
  return sample;
}

class ServerReplicas : public ServerFixture {
 protected:
  /// Starts another server.
  void restart() {
    start({.cache = cache_});
    stub_ = client();
    const Created created = create(*stub_, upload(*stub_, sphere_off(4)), 2000);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    id_ = created.session.session_id();
  }
  std::string points_of(const v1::SampleRequest& sample) {
    const Resampled resampled = resample(*stub_, id_, sample);
    EXPECT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    EXPECT_EQ(resampled.points(), kPoints);
    return resampled.bytes();
  }
  v1::Session session() {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(id_);
    v1::GetSessionResponse response;
    EXPECT_TRUE(stub_->GetSession(&context, request, &response).ok());
    return response.session();
  }
  void refine() {
    EXPECT_TRUE(resample(*stub_, id_, refining_view()).status.ok());
    EXPECT_TRUE(eventually([&] { return session().curve_revision() > 1 && !session().refining(); }));
  }

  std::string cache_;
  std::unique_ptr<Stub> stub_;
  std::string id_;
};

TEST_F(ServerReplicas, WhateverWasLookedAtBefore) {
  const v1::SampleRequest far = ranked_view(0, 0, 1, 3), near = ranked_view(1, 0.5, 0.2, 0.05),
                          nearby = ranked_view(1, 0.52, 0.2, 0.02), deep = ranked_view(1, 0.51, 0.21, 0.004);
  restart();
  points_of(far);
  points_of(near);
  points_of(nearby);
  const std::string points = points_of(deep), before = points_of(near);
  restart();
  EXPECT_EQ(points_of(deep), points) << "at once";
  EXPECT_EQ(points_of(near), before);
  restart();
  refine();
  points_of(nearby);
  EXPECT_EQ(points_of(deep), points) << "after the curve was refined";
  EXPECT_EQ(points_of(near), before);
}

TEST_F(ServerReplicas, AfterARestartOnARefinedCurve) {
  const testing::TemporaryFolder folder;
  cache_ = folder.path();
  const v1::SampleRequest deep = ranked_view(1, 0.51, 0.21, 0.004);
  restart();
  const std::string points = points_of(deep);
  refine();
  const std::uint64_t revision = session().curve_revision();
  EXPECT_TRUE(eventually([&] {  // the refined curve has a file of its own
    const std::vector<std::string> names = folder.names();
    return std::ranges::any_of(names, [](const std::string& name) { return name.ends_with(".refined"); });
  }));
  restart();
  EXPECT_GE(session().curve_revision(), 2u);
  EXPECT_LE(session().curve_revision(), revision);
  EXPECT_EQ(points_of(deep), points);
}

}  // namespace
}  // namespace curvecast::server
