#include "core/mesh_io/reading/texture_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/core/mesh_io/image_writers.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kPlenty = 1 << 20;

Image gradient(int width, int height) {
  Image image = plain_image(width, height, 0, 0, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgba[4 * (y * width + x)] = static_cast<std::uint8_t>(255 * x / width);
      image.rgba[4 * (y * width + x) + 1] = static_cast<std::uint8_t>(255 * y / height);
      image.rgba[4 * (y * width + x) + 2] = 77;
    }
  }
  return image;
}

TEST(TextureImage, PngComesBackAsItWas) {
  Image image = gradient(33, 17);
  image.rgba[3] = 100;
  const absl::StatusOr<Image> decoded = decode_texture(png_file(image), kPlenty);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->width, 33);
  EXPECT_EQ(decoded->height, 17);
  EXPECT_EQ(decoded->rgba, image.rgba);
}

TEST(TextureImage, JpegComesBackNearly) {
  const Image image = gradient(64, 48);
  const absl::StatusOr<Image> decoded = decode_texture(jpeg_file(image), kPlenty);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->rgba.size(), image.rgba.size());
  for (std::size_t i = 0; i < image.rgba.size(); ++i) EXPECT_NEAR(decoded->rgba[i], image.rgba[i], 12) << i;
}

TEST(TextureImage, WebpComesBackAsItWasOrNearly) {
  Image image = gradient(33, 17);
  image.rgba[3] = 100;
  const absl::StatusOr<Image> decoded = decode_texture(webp_file(image), kPlenty);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->width, 33);
  EXPECT_EQ(decoded->height, 17);
  EXPECT_EQ(decoded->rgba, image.rgba);
  const Image opaque = gradient(64, 48);
  const absl::StatusOr<Image> lossy = decode_texture(webp_file(opaque, false), kPlenty);
  ASSERT_TRUE(lossy.ok()) << lossy.status();
  ASSERT_EQ(lossy->rgba.size(), opaque.rgba.size());
  for (std::size_t i = 0; i < opaque.rgba.size(); ++i) EXPECT_NEAR(lossy->rgba[i], opaque.rgba[i], 16) << i;
}

TEST(TextureImage, WebpOfOneColourMayBeLargeButNotAnyhow) {
  const std::string file = webp_file(plain_image(4'000, 4'000, 1, 2, 3));
  EXPECT_LT(file.size(), 1'000u);
  EXPECT_TRUE(decode_texture(file, std::uint64_t{1} << 26).ok());
  const std::string larger = webp_file(plain_image(8'000, 6'000, 1, 2, 3));
  EXPECT_THAT(std::string(decode_texture(larger, std::uint64_t{1} << 26).status().message()),
              HasSubstr("claims 8000 x 6000 pixels, more than its"));
}

TEST(TextureImage, RefusesWhatItCannotHold) {
  for (const std::string& file : {png_file(gradient(64, 48)), jpeg_file(gradient(64, 48)), webp_file(gradient(64, 48))}) {
    EXPECT_EQ(decode_texture(file, 64 * 48 - 1).status().code(), absl::StatusCode::kResourceExhausted);
    EXPECT_TRUE(decode_texture(file, 64 * 48).ok());
  }
  EXPECT_THAT(std::string(decode_texture(std::string("GIF89a"), kPlenty).status().message()),
              HasSubstr("neither PNG, JPEG nor WebP"));
  EXPECT_FALSE(decode_texture({}, kPlenty).ok());
}

TEST(TextureImage, DamagedFilesAreAnErrorOrAPicture) {
  std::mt19937 random(5);
  for (const std::string& file : {png_file(gradient(20, 20)), jpeg_file(gradient(20, 20)), webp_file(gradient(20, 20)),
                                  webp_file(gradient(20, 20), false)}) {
    for (std::size_t length = 0; length < file.size(); ++length)
      static_cast<void>(decode_texture(file.substr(0, length), kPlenty));
    for (int round = 0; round < 2'000; ++round) {
      std::string damaged = file;
      for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
      const absl::StatusOr<Image> image = decode_texture(damaged, kPlenty);
      if (!image.ok()) continue;
      EXPECT_EQ(image->rgba.size(), 4 * static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height));
    }
  }
}

}  // namespace
}  // namespace curvecast
