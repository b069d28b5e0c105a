#include "proto/terms/camera_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace curvecast::terms {
namespace {

using ::testing::HasSubstr;
using Vector = std::array<double, 3>;

std::string error_of(const std::string& text) {
  const absl::Status status = parse_camera_term(text).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
  return std::string(status.message());
}

v1::Vec3 vec(double x, double y, double z) {
  v1::Vec3 v;
  v.set_x(x);
  v.set_y(y);
  v.set_z(z);
  return v;
}

TEST(CameraTerm, ReadsAllParts) {
  const auto option = parse_camera_term("eye=1,2.5,-3e2,target=0,0,1,up=0,0,2,fov=60");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->eye, Vector({1, 2.5, -300}));
  EXPECT_EQ(*option->target, Vector({0, 0, 1}));
  EXPECT_EQ(*option->up, Vector({0, 0, 2}));
  EXPECT_EQ(*option->fov_degrees, 60);
}

TEST(CameraTerm, PartsAreOptionalAndInAnyOrder) {
  const auto option = parse_camera_term("fov=10,eye=1,2,3");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->eye, Vector({1, 2, 3}));
  EXPECT_FALSE(option->target || option->up);
  EXPECT_TRUE(parse_camera_term("up=1,0,0").ok());
  EXPECT_TRUE(parse_camera_term("up=0,1,0,eye=0,5,0").ok()) << "the target is not known yet";
}

TEST(CameraTerm, MayBeOrthographic) {
  const auto option = parse_camera_term("eye=1,2,3,ortho=2.5");
  ASSERT_TRUE(option.ok()) << option.status();
  EXPECT_EQ(*option->height, 2.5);
}

TEST(CameraTerm, MayHaveAnAspect) {
  EXPECT_EQ(*parse_camera_term("aspect=1.5,fov=20")->aspect, 1.5);
  EXPECT_FALSE(parse_camera_term("fov=20")->aspect);
  EXPECT_THAT(error_of("aspect=0"), HasSubstr("aspect is 0; it must lie between 0.01 and 100"));
  EXPECT_THAT(error_of("aspect=16,9"), HasSubstr("aspect takes 1 number"));
}

TEST(CameraTerm, RefusesWhatIsWrong) {
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

TEST(CompleteCamera, TakesWhatIsNotSaidFromTheWholeView) {
  v1::Camera whole;
  *whole.mutable_eye() = vec(1, 2, 12);
  *whole.mutable_target() = vec(1, 2, 2);
  const auto camera = complete_camera(*parse_camera_term("fov=50"), vec(1, 2, 3), whole);
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_EQ(camera->eye().z(), 12);
  EXPECT_EQ(camera->target().z(), 2);
  EXPECT_EQ(camera->up().y(), 1);
  EXPECT_EQ(camera->vertical_fov_degrees(), 50);
  const auto moved = complete_camera(*parse_camera_term("target=0,0,0,ortho=3"), vec(1, 2, 3), whole);
  EXPECT_EQ(moved->eye().z(), 10) << "as far away, in the same direction";
  EXPECT_EQ(moved->orthographic_height(), 3);
  EXPECT_EQ(complete_camera(*parse_camera_term("eye=9,9,9"), vec(1, 2, 3), whole)->target().z(), 3);
  EXPECT_EQ(complete_camera(*parse_camera_term("eye=1,9,3"), vec(1, 2, 3), whole)->up().z(), 1) << "straight down";
  EXPECT_TRUE(absl::IsInvalidArgument(complete_camera(*parse_camera_term("eye=1,2,3"), vec(1, 2, 3), whole).status()));
}

}  // namespace
}  // namespace curvecast::terms
