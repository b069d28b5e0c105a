#include "client/cli/camera_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "client/cli/camera_option.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

const Box3d kBox{Vec3d(-1, -2, -3), Vec3d(5, 4, 3)};

TEST(CameraPath, OrbitKeepsItsDistanceAndNeverRepeats) {
  const auto cameras = make_camera_path("orbit", 12, kBox);
  ASSERT_TRUE(cameras.ok()) << cameras.status();
  ASSERT_EQ(cameras->size(), 12U);
  const double distance = (to_vec((*cameras)[0].eye()) - to_vec((*cameras)[0].target())).norm();
  Vec3d mean = Vec3d::Zero();
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    EXPECT_TRUE(check_camera((*cameras)[i]).ok());
    const Vec3d offset = to_vec((*cameras)[i].eye()) - to_vec((*cameras)[i].target());
    EXPECT_NEAR(offset.norm(), distance, 1e-9 * distance);
    mean += offset / 12;
    if (i > 0) {
      EXPECT_GT((to_vec((*cameras)[i].eye()) - to_vec((*cameras)[i - 1].eye())).norm(), 0.1 * distance);
    }
  }
  EXPECT_NEAR(mean.x(), 0, 1e-9 * distance);
  EXPECT_NEAR(mean.z(), 0, 1e-9 * distance);
}

TEST(CameraPath, ZoomComesCloserAndStaysOutside) {
  for (const std::size_t frames : {1UL, 2UL, 20UL}) {
    const auto cameras = make_camera_path("zoom", frames, kBox);
    ASSERT_TRUE(cameras.ok()) << cameras.status();
    ASSERT_EQ(cameras->size(), frames);
    double last = std::numeric_limits<double>::infinity();
    for (const v1::Camera& camera : *cameras) {
      EXPECT_TRUE(check_camera(camera).ok());
      const double distance = (to_vec(camera.eye()) - to_vec(camera.target())).norm();
      EXPECT_LT(distance, last);
      EXPECT_GT(distance, 0.5 * kBox.diagonal());
      last = distance;
    }
  }
}

TEST(CameraPath, ReadsAFile) {
  const auto cameras = parse_camera_path("views", "# a comment\n1 2 3 0 0 0 0 1 0 45\n\n 4,5,6, 0,0,0, 0,0,1, 30 # another\r\n");
  ASSERT_TRUE(cameras.ok()) << cameras.status();
  ASSERT_EQ(cameras->size(), 2U);
  EXPECT_EQ(to_vec((*cameras)[1].eye()), Vec3d(4, 5, 6));
  EXPECT_EQ(to_vec((*cameras)[1].up()), Vec3d(0, 0, 1));
  EXPECT_EQ((*cameras)[1].vertical_fov_degrees(), 30);
}

TEST(CameraPath, NamesTheLineAtFault) {
  const std::string good = "1 2 3 0 0 0 0 1 0 45\n";
  for (const char* bad : {"1 2 3", "1 2 3 0 0 0 0 1 0 45 6", "1 2 3 0 0 0 0 1 0 x", "0 0 0 0 0 0 0 1 0 45",
                          "1 2 3 0 0 0 0 1 0 180", "nan 2 3 0 0 0 0 1 0 45"}) {
    const absl::Status status = parse_camera_path("views.txt", good + bad).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << bad;
    EXPECT_THAT(std::string(status.message()), HasSubstr("views.txt: line 2: ")) << bad;
  }
  EXPECT_TRUE(absl::IsInvalidArgument(parse_camera_path("views.txt", "# nothing\n").status()));
}

TEST(CameraPath, RepeatsOrCutsAFileToTheFramesWanted) {
  const std::string path = ::testing::TempDir() + "/curvecast_camera_path.txt";
  ASSERT_TRUE(client::write_bytes(path, "1 0 0 0 0 0 0 1 0 45\n2 0 0 0 0 0 0 1 0 45\n3 0 0 0 0 0 0 1 0 45\n").ok());
  for (const std::size_t frames : {1UL, 3UL, 8UL}) {
    const auto cameras = make_camera_path(path, frames, kBox);
    ASSERT_TRUE(cameras.ok()) << cameras.status();
    ASSERT_EQ(cameras->size(), frames);
    for (std::size_t i = 0; i < frames; ++i) EXPECT_EQ((*cameras)[i].eye().x(), 1 + i % 3);
  }
  EXPECT_TRUE(absl::IsNotFound(make_camera_path(path + ".missing", 3, kBox).status()));
}

}  // namespace
}  // namespace curvecast::cli
