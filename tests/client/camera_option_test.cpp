#include "client/cli/camera_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

const Box3d kBox{Vec3d(-1, 2, 3), Vec3d(5, 4, 9)};

std::string error_of(const std::string& text) {
  const absl::Status status = parse_camera(text).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
  return std::string(status.message());
}

TEST(ParseCamera, ReadsAllParts) {
  const auto option = parse_camera("eye=1,2.5,-3e2,target=0,0,1,up=0,0,2,fov=60");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->eye, Vec3d(1, 2.5, -300));
  EXPECT_EQ(*option->target, Vec3d(0, 0, 1));
  EXPECT_EQ(*option->up, Vec3d(0, 0, 2));
  EXPECT_EQ(*option->fov_degrees, 60);
}

TEST(ParseCamera, PartsAreOptionalAndInAnyOrder) {
  const auto option = parse_camera("fov=10,eye=1,2,3");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->eye, Vec3d(1, 2, 3));
  EXPECT_FALSE(option->target || option->up);
  EXPECT_TRUE(parse_camera("up=1,0,0").ok());
  EXPECT_TRUE(parse_camera("up=0,1,0,eye=0,5,0").ok()) << "the target is not known yet";
}

TEST(ParseCamera, MayBeOrthographic) {
  const auto option = parse_camera("eye=1,2,3,ortho=2.5");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->height, 2.5);
  EXPECT_EQ(resolve_camera(*option, kBox, 1)->orthographic_height(), 2.5);
  EXPECT_EQ(resolve_camera({}, kBox, 1)->orthographic_height(), 0);
}

TEST(ParseCamera, MayHaveAnAspect) {
  EXPECT_EQ(*parse_camera("aspect=1.5,fov=20")->aspect, 1.5);
  EXPECT_FALSE(parse_camera("fov=20")->aspect);
  EXPECT_THAT(error_of("aspect=0"), HasSubstr("aspect is 0; it must lie between 0.01 and 100"));
  EXPECT_THAT(error_of("aspect=16,9"), HasSubstr("aspect takes 1 number"));
}

TEST(ParseCamera, RefusesWhatIsWrong) {
  EXPECT_THAT(error_of("eye=1,2"), HasSubstr("eye takes 3 numbers, not 2"));
  EXPECT_THAT(error_of("eye=1,2,3,4"), HasSubstr("not 4"));
  EXPECT_THAT(error_of("fov=1,2"), HasSubstr("fov takes 1 number"));
  EXPECT_THAT(error_of("eye=1,2,x"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(error_of("eye=1,2,3,eye=1,2,3"), HasSubstr("given twice"));
  EXPECT_THAT(error_of("zoom=3"), HasSubstr("there are: eye, target, up, fov, ortho, aspect"));
  EXPECT_THAT(error_of("1,2,3"), HasSubstr("does not begin"));
  EXPECT_THAT(error_of("ortho=0"), HasSubstr("ortho is 0; it must be above 0"));
  EXPECT_THAT(error_of("ortho=1,2"), HasSubstr("ortho takes 1 number"));
  EXPECT_THAT(error_of("eye=1,2,3,target=1,2,3"), HasSubstr("same point"));
  EXPECT_THAT(error_of("eye=0,5,0,target=0,0,0,up=0,1,0"), HasSubstr("along the view"));
  EXPECT_THAT(error_of("up=0,0,0"), HasSubstr("up"));
  for (const char* text : {"", ",", "eye", "eye=", "eye=nan,0,0", "eye=inf,0,0", "fov=0", "fov=180", "fov=-5", "fov=nan"}) {
    EXPECT_FALSE(error_of(text).empty()) << text;
  }
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
  option.eye = above;
  EXPECT_TRUE(resolve_camera(option, kBox, 1).ok());
  option.eye = kBox.center();
  EXPECT_TRUE(absl::IsInvalidArgument(resolve_camera(option, kBox, 1).status()));
}

}  // namespace
}  // namespace curvecast::cli
