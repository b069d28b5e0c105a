#include "core/measure/picture_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/measure/test_pictures.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(PictureError, OfTheSamePictureIsNone) {
  EXPECT_TRUE(std::isinf(psnr(scene_picture(), scene_picture())));
  EXPECT_NEAR(ssim(scene_picture(), scene_picture()), 1, 1e-6);
}

TEST(PictureError, OfOneStepEverywhereIsTheLeastThatPicturesCanHave) {
  const Image grey = picture_of([](int, int, int) { return 100; }), next = picture_of([](int, int, int) { return 101; });
  EXPECT_NEAR(psnr(grey, next), 20 * std::log10(255.0), 1e-9);
  EXPECT_GT(ssim(grey, next), 0.999);
}

// What scikit-image 0.25 gives for these pictures: peak_signal_noise_ratio, structural_similarity with Gaussian weights.
TEST(PictureError, IsWhatOthersCompute) {
  EXPECT_NEAR(psnr(scene_picture(), scene_picture(1)), 24.548982, 1e-5);
  EXPECT_NEAR(psnr(scene_picture(), scene_picture(4)), 18.751967, 1e-5);
  EXPECT_NEAR(psnr(scene_picture(), noisy_picture()), 29.589345, 1e-5);
  EXPECT_NEAR(ssim(scene_picture(), scene_picture(1)), 0.9302869, 2e-5);
  EXPECT_NEAR(ssim(scene_picture(), scene_picture(4)), 0.8085592, 2e-5);
  EXPECT_NEAR(ssim(scene_picture(), noisy_picture()), 0.5419998, 2e-5);
  EXPECT_NEAR(ssim(scene_picture(), dark_picture()), 0.7674108, 2e-5);
}

}  // namespace
}  // namespace curvecast
