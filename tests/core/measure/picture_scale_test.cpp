#include "core/measure/picture_scale.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace curvecast {
namespace {

TEST(PictureScale, FallsWithDepthWithinThePicture) {
  Camera camera;  // looks along -z
  camera.fov = std::numbers::pi / 2;
  camera.pixels = 1000;
  camera.aspect = 2;
  const std::vector<Camera> cameras = {camera};
  const PictureScale scale(cameras);
  EXPECT_NEAR(scale.pixels({0, 0, -1}), 500, 1e-9);
  EXPECT_NEAR(scale.pixels({0, 0, -10}), 50, 1e-9);
  EXPECT_NEAR(scale.pixels({1.9, -0.9, -1}), 500, 1e-9) << "across the view, not along the ray";
  EXPECT_EQ(scale.pixels({0, 1.1, -1}), 0);
  EXPECT_EQ(scale.pixels({2.1, 0, -1}), 0);
  EXPECT_EQ(scale.pixels({0, 0, 1}), 0) << "behind the eye";
  EXPECT_EQ(scale.pixels({0, 0, 0}), 0);
}

TEST(PictureScale, IsTheSameEverywhereForParallelRays) {
  Camera camera;
  camera.height = 4;
  camera.pixels = 1000;
  const std::vector<Camera> cameras = {camera};
  const PictureScale scale(cameras);
  for (const double z : {-100.0, 0.0, 100.0}) EXPECT_DOUBLE_EQ(scale.pixels({1.9, -1.9, z}), 250);
  EXPECT_EQ(scale.pixels({2.1, 0, 0}), 0);
}

TEST(PictureScale, OfSeveralCamerasIsTheLargest) {
  Camera near, far;
  near.eye = {0, 0, 1};
  far.eye = {0, 0, 10};
  near.target = far.target = {0, 0, 0};
  const std::vector<Camera> cameras = {far, near}, one = {near};
  EXPECT_DOUBLE_EQ(PictureScale(cameras).pixels({0, 0, 0}), PictureScale(one).pixels({0, 0, 0}));
  EXPECT_GT(PictureScale(cameras).pixels({2, 0, 0}), 0) << "only the far one sees it";
  EXPECT_EQ(PictureScale({}).pixels({0, 0, 0}), 0);
}

}  // namespace
}  // namespace curvecast
