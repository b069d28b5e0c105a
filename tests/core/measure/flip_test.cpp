#include "core/measure/flip.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/measure/test_pictures.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(FlipError, OfTheSamePictureIsNone) {
  const FlipError error = flip_error(scene_picture(), scene_picture());
  EXPECT_EQ(error.mean, 0);
  EXPECT_EQ(std::ranges::count(error.error, 0.0f), 64 * 48);
}

// What NVIDIA's flip-evaluator 1.7 gives for these pictures.
TEST(FlipError, IsWhatItsAuthorsCompute) {
  EXPECT_NEAR(flip_error(scene_picture(), scene_picture(1)).mean, 0.0463232, 2e-5);
  EXPECT_NEAR(flip_error(scene_picture(), scene_picture(4)).mean, 0.1208553, 2e-5);
  EXPECT_NEAR(flip_error(scene_picture(), noisy_picture()).mean, 0.0317932, 2e-5);
  EXPECT_NEAR(flip_error(scene_picture(), dark_picture()).mean, 0.7604350, 2e-4);
}

TEST(FlipError, LiesWhereThePicturesDiffer) {
  const FlipError error = flip_error(scene_picture(), scene_picture(4));
  ASSERT_EQ(error.error.size(), 64u * 48);
  EXPECT_GT(error.error[24 * 64 + 34], 0.5f) << "in what the disc has covered";
  EXPECT_LT(error.error[24 * 64 + 60], 1e-3f) << "far from it";
}

TEST(FlipError, FallsWithDistance) {
  const double near = flip_error(scene_picture(), noisy_picture(), 20).mean;
  const double far = flip_error(scene_picture(), noisy_picture(), 120).mean;
  EXPECT_LT(far, 0.7 * near);
}

TEST(FlipError, TakesPicturesOfOnePixel) {
  const Image black{1, 1, {0, 0, 0, 255}}, white{1, 1, {255, 255, 255, 255}};
  EXPECT_NEAR(flip_error(black, white).mean, 1, 0.05);
}

}  // namespace
}  // namespace curvecast
