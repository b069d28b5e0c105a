#include "client/bench/picture/compare_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace curvecast::cli::bench {
namespace {

constexpr RenderOptions kSize{.width = 40, .height = 30};
constexpr Rgb8 kGrey = {90, 100, 110};

/// Draws what covers(x, y) says of the middles of pixels.
std::function<absl::StatusOr<Image>(const RenderOptions&)> drawing(const std::function<bool(int x, int y)>& covers) {
  return [covers](const RenderOptions& options) -> absl::StatusOr<Image> {
    Image image{options.width, options.height, {}};
    for (int y = 0; y < options.height; ++y) {
      for (int x = 0; x < options.width; ++x) {
        const Rgb8& colour = covers(x, y) ? kGrey : options.background_top;
        image.rgba.insert(image.rgba.end(), {colour[0], colour[1], colour[2], 255});
      }
    }
    return image;
  };
}

bool in_square(int x, int y) { return x >= 10 && x < 30 && y >= 5 && y < 25; }

PictureScore score(const std::function<bool(int x, int y)>& covers) {
  const auto reference = PictureReference::draw(drawing(in_square), kSize);
  EXPECT_TRUE(reference.ok()) << reference.status();
  Image image;
  const auto scored = reference->score(drawing(covers), image);
  EXPECT_TRUE(scored.ok()) << scored.status();
  EXPECT_EQ(image.width, kSize.width);
  return *scored;
}

TEST(ComparePictures, TheSamePictureHasNoError) {
  const PictureScore same = score(in_square);
  EXPECT_EQ(same.flip, 0);
  EXPECT_TRUE(std::isinf(same.psnr));
  EXPECT_EQ(same.outline + same.holes, 0u);
}

TEST(ComparePictures, HolesAndOutlinesAreTwoThings) {
  const PictureScore hole = score([](int x, int y) { return in_square(x, y) && !(x >= 19 && x < 21 && y >= 14 && y < 17); });
  EXPECT_EQ(hole.holes, 6u);
  EXPECT_EQ(hole.outline, 0u);
  const PictureScore wider = score([](int x, int y) { return in_square(x, y) || in_square(x - 1, y); });
  EXPECT_EQ(wider.holes, 0u);
  EXPECT_EQ(wider.outline, 20u);
  const PictureScore narrower = score([](int x, int y) { return in_square(x, y) && in_square(x - 1, y); });
  EXPECT_EQ(narrower.outline, 20u);
  EXPECT_GT(narrower.flip, 0);
  EXPECT_LT(narrower.ssim, 1);
}

TEST(ComparePictures, WhatIsCoveredFarFromTheMeshIsNoHole) {
  const PictureScore beside = score([](int x, int y) { return in_square(x, y) || (x == 3 && y == 3); });
  EXPECT_EQ(beside.holes + beside.outline, 0u);
  EXPECT_LT(beside.psnr, 60);
}

TEST(ComparePictures, ErrorsOfWhoDrawsAreHandedOn) {
  const auto fails = [](const RenderOptions&) -> absl::StatusOr<Image> { return absl::InternalError("no"); };
  EXPECT_EQ(PictureReference::draw(fails, kSize).status(), absl::InternalError("no"));
  Image image;
  EXPECT_EQ(PictureReference::draw(drawing(in_square), kSize)->score(fails, image).status(), absl::InternalError("no"));
}

}  // namespace
}  // namespace curvecast::cli::bench
