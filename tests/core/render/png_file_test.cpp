#include "core/render/png_file.h"

#include <gtest/gtest.h>
#include <png.h>

namespace curvecast {
namespace {

// A picture whose every byte tells its place; `alpha` 0: a pattern of alphas.
Image make_pattern(int width, int height, std::uint8_t alpha) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int value : {x * 7 + y, y * 5, x ^ y, alpha != 0 ? alpha : x + y}) {
        image.rgba.push_back(static_cast<std::uint8_t>(value));
      }
    }
  }
  return image;
}

// Through libpng's own simplified reader. `format` is the one that the file has.
Image decode(const std::string& bytes, png_uint_32* format) {
  png_image reader = {};
  reader.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&reader, bytes.data(), bytes.size())) << reader.message;
  *format = reader.format;
  reader.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(reader.width), static_cast<int>(reader.height), {}};
  image.rgba.resize(PNG_IMAGE_SIZE(reader));
  EXPECT_TRUE(png_image_finish_read(&reader, nullptr, image.rgba.data(), 0, nullptr)) << reader.message;
  return image;
}

TEST(PngFile, OpaquePicturesRoundTripAsRgb) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 300), std::pair(257, 3), std::pair(64, 48)}) {
    const Image image = make_pattern(width, height, 255);
    const absl::StatusOr<std::string> bytes = encode_png(image);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    png_uint_32 format = 0;
    const Image back = decode(*bytes, &format);
    EXPECT_EQ(format & PNG_FORMAT_FLAG_ALPHA, 0U);
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.rgba, image.rgba);
  }
}

TEST(PngFile, AlphaIsKept) {
  const Image image = make_pattern(31, 17, 0);
  const absl::StatusOr<std::string> bytes = encode_png(image);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  png_uint_32 format = 0;
  EXPECT_EQ(decode(*bytes, &format).rgba, image.rgba);
  EXPECT_NE(format & PNG_FORMAT_FLAG_ALPHA, 0U);
}

TEST(PngFile, RefusesPicturesThatAreNone) {
  const auto code = [](const Image& image) { return encode_png(image).status().code(); };
  EXPECT_EQ(code(Image{}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{-1, 4, {}}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{2, 2, std::vector<std::uint8_t>(15)}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{2'000'000'000, 2'000'000'000, {}}), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
