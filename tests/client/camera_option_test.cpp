#include "client/cli/camera_option.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace curvecast::cli {
namespace {

const Box3d kBox{Vec3d(-1, 2, 3), Vec3d(5, 4, 9)};

TEST(ResolveCamera, MayBeOrthographic) {
  EXPECT_EQ(resolve_camera(*parse_camera("eye=1,2,3,ortho=2.5"), kBox, 1)->orthographic_height(), 2.5);
  EXPECT_EQ(resolve_camera({}, kBox, 1)->orthographic_height(), 0);
}

TEST(ResolveCamera, SeesTheWholeBoxByDefault) {
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const auto camera = resolve_camera({}, kBox, aspect);
    ASSERT_TRUE(camera.ok()) << camera.status();
    const Vec3d eye = to_vec(camera->eye());
    const Vec3d forward = (to_vec(camera->target()) - eye).normalized();
    const Vec3d right = forward.cross(to_vec(camera->up())).normalized();
    const Vec3d up = right.cross(forward);
    const double tangent = std::tan(camera->vertical_fov_degrees() * std::numbers::pi / 360);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d p(corner & 1 ? kBox.max.x() : kBox.min.x(), corner & 2 ? kBox.max.y() : kBox.min.y(),
                    corner & 4 ? kBox.max.z() : kBox.min.z());
      const double depth = forward.dot(p - eye);
      EXPECT_GT(depth, 0);
      EXPECT_LE(std::abs(up.dot(p - eye)), depth * tangent);
      EXPECT_LE(std::abs(right.dot(p - eye)), depth * tangent * aspect);
    }
  }
}

TEST(ResolveCamera, KeepsWhatTheUserSaid) {
  const auto camera = resolve_camera(*parse_camera("eye=0,0,50,fov=70"), kBox, 1);
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_EQ(to_vec(camera->eye()), Vec3d(0, 0, 50));
  EXPECT_EQ(to_vec(camera->target()), kBox.center());
  EXPECT_EQ(camera->vertical_fov_degrees(), 70);
  const auto other = resolve_camera(*parse_camera("target=7,8,9,up=1,0,0"), kBox, 1);
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_EQ(to_vec(other->target()), Vec3d(7, 8, 9));
  EXPECT_EQ(to_vec(other->up()), Vec3d(1, 0, 0));
}

TEST(ResolveCamera, LooksStraightDownWithoutBeingToldAnUp) {
  const Vec3d above = kBox.center() + Vec3d(0, 10, 0);
  CameraOption option;
  option.eye = {above.x(), above.y(), above.z()};
  EXPECT_TRUE(resolve_camera(option, kBox, 1).ok());
  option.eye = {kBox.center().x(), kBox.center().y(), kBox.center().z()};
  EXPECT_TRUE(absl::IsInvalidArgument(resolve_camera(option, kBox, 1).status()));
}

}  // namespace
}  // namespace curvecast::cli
