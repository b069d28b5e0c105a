#include "core/render/jpeg_file.h"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <cmath>
#include <cstdlib>

namespace curvecast {
namespace {

/// Smooth, as photographs are: a JPEG of it comes near to it.
Image make_gradient(int width, int height, std::uint8_t alpha = 255) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const double value : {255.0 * x / width, 255.0 * y / height, 128 + 100 * std::sin(0.05 * (x + y)), 1.0 * alpha}) {
        image.rgba.push_back(static_cast<std::uint8_t>(value));
      }
    }
  }
  return image;
}

/// Through libturbojpeg's own reader.
Image decode(const std::string& bytes) {
  const tjhandle reader = tjInitDecompress();
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colour_space = 0;
  EXPECT_EQ(tjDecompressHeader3(reader, data, bytes.size(), &width, &height, &subsampling, &colour_space), 0);
  Image image{width, height, {}};
  image.rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  EXPECT_EQ(tjDecompress2(reader, data, bytes.size(), image.rgba.data(), width, 0, height, TJPF_RGBA, 0), 0);
  tjDestroy(reader);
  return image;
}

/// The greatest difference of any colour of any pixel.
int greatest_error(const Image& a, const Image& b) {
  int greatest = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % 4 != 3) greatest = std::max(greatest, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  }
  return greatest;
}

TEST(JpegFile, ComesBackNearly) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 300), std::pair(257, 3), std::pair(640, 360)}) {
    const Image image = make_gradient(width, height);
    const absl::StatusOr<std::string> bytes = encode_jpeg(image, 95);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const Image back = decode(*bytes);
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, height);
    EXPECT_LE(greatest_error(image, back), 12) << width << " x " << height;
  }
}

TEST(JpegFile, LessQualityTakesFewerBytes) {
  const Image image = make_gradient(320, 240);
  std::size_t before = 0;
  for (const int quality : {1, 30, kUsualJpegQuality, 100}) {
    const absl::StatusOr<std::string> bytes = encode_jpeg(image, quality);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    EXPECT_GT(bytes->size(), before) << quality;
    before = bytes->size();
  }
  EXPECT_EQ(encode_jpeg(image).value_or(""), encode_jpeg(image, kUsualJpegQuality).value_or("none"));
}

TEST(JpegFile, LeavesAlphaOut) {
  EXPECT_EQ(encode_jpeg(make_gradient(40, 30, 7)).value_or(""), encode_jpeg(make_gradient(40, 30)).value_or("none"));
}

TEST(JpegFile, RefusesPicturesThatAreNone) {
  const auto code = [](const Image& image, int quality) { return encode_jpeg(image, quality).status().code(); };
  EXPECT_EQ(code(Image{}, 85), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{-1, 4, {}}, 85), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{2, 2, std::vector<std::uint8_t>(15)}, 85), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Image{70'000, 1, std::vector<std::uint8_t>(280'000)}, 85), absl::StatusCode::kInvalidArgument);
  for (const int quality : {-1, 0, 101}) EXPECT_EQ(code(make_gradient(2, 2), quality), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
