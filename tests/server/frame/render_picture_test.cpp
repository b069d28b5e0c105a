// Pictures of the mesh itself beside those of its points.
#include "server/frame/render_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "core/mesh_io/reading/texture_image.h"
#include "core/render/png_file.h"
#include "server/convert/convert.h"
#include "tests/server/ball_session.h"
#include "tests/support/counting_source.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

constexpr int kSide = 200;  // pixels

v1::RenderRequest request_of(v1::PictureStyle style, const Vec3d& eye, const Vec3d& target, std::uint64_t points) {
  v1::RenderRequest request;
  request.set_style(style);
  request.set_width(kSide);
  request.set_height(kSide);
  request.mutable_sample()->set_points(points);
  v1::Camera& camera = *request.mutable_sample()->add_cameras();
  *camera.mutable_eye() = to_proto(eye);
  *camera.mutable_target() = to_proto(target);
  camera.set_vertical_fov_degrees(40);
  return request;
}

Image drawn(const Session& session, const v1::RenderRequest& request, const ExecutionContext& context = {}) {
  ViewCache cache;
  const absl::StatusOr<v1::RenderResponse> response = render_picture(session, request, cache, context);
  EXPECT_TRUE(response.ok()) << response.status();
  if (!response.ok()) return {};
  EXPECT_EQ(response->points(), request.style() == v1::PICTURE_STYLE_MESH ? 0 : request.sample().points());
  absl::StatusOr<Image> image = decode_texture(response->png(), 1 << 24);
  EXPECT_TRUE(image.ok()) << image.status();
  return image.value_or(Image());
}

const std::uint8_t* pixel(const Image& image, int x, int y) { return &image.rgba[4 * static_cast<std::size_t>(y * kSide + x)]; }

/// Over the pixels for which `counts(x, y)`, decibels.
template <typename Counts>
double psnr(const Image& a, const Image& b, const Counts& counts) {
  double sum = 0, count = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (!counts(x, y)) continue;
      for (int c = 0; c < 3; ++c) sum += std::pow(int{pixel(a, x, y)[c]} - int{pixel(b, x, y)[c]}, 2);
      count += 3;
    }
  }
  EXPECT_GT(count, 1000);
  return 10 * std::log10(255 * 255 * count / std::max(sum, 1.0));
}

TEST(RenderPicture, PointsBecomeTheMesh) {
  const auto ball = make_session(200'000);
  const Vec3d eye(1, 1.5, 3.5);
  const Image mesh = drawn(*ball, request_of(v1::PICTURE_STYLE_MESH, eye, Vec3d::Zero(), 1));
  // Of radius 1, without the outline.
  const double radius = std::tan(std::asin(1 / eye.norm())) / std::tan(20 * std::numbers::pi / 180) * kSide / 2;
  const auto is_inside = [&](int x, int y) { return std::hypot(x + 0.5 - 0.5 * kSide, y + 0.5 - 0.5 * kSide) < radius - 3; };
  double before = 0;
  for (const std::uint64_t points : {500, 5'000, 200'000}) {
    const double now = psnr(mesh, drawn(*ball, request_of(v1::PICTURE_STYLE_SURFACE, eye, Vec3d::Zero(), points)), is_inside);
    EXPECT_GT(now, before) << points;
    before = now;
  }
  EXPECT_GT(before, 55);
}

TEST(RenderPicture, ATextureIsSeenAtPointsAndOnTheMesh) {
  // Red on the left, blue on the right.
  Image texture{32, 32, {}};
  for (int i = 0; i < 32 * 32; ++i) {
    const bool is_left = i % 32 < 16;
    for (const int value : {is_left ? 255 : 0, 0, is_left ? 0 : 255, 255})
      texture.rgba.push_back(static_cast<std::uint8_t>(value));
  }
  const std::string png = encode_png(texture).value_or(""), library = "newmtl picture\nmap_Kd picture.png\n";
  const std::string obj =
      "mtllib square.mtl\nusemtl picture\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3 4/4\n";
  const auto square = make_session(5'000, {"square.obj", obj, [&](std::string_view name) -> std::optional<std::span<const char>> {
                                             if (name == "square.mtl") return library;
                                             if (name == "picture.png") return png;
                                             return std::nullopt;
                                           }});
  const auto request = [](v1::PictureStyle style) { return request_of(style, Vec3d(0.5, 0.5, 2), Vec3d(0.5, 0.5, 0), 5'000); };
  for (const v1::PictureStyle style : {v1::PICTURE_STYLE_SURFACE, v1::PICTURE_STYLE_MESH}) {
    for (const bool is_plain : {false, true}) {
      SCOPED_TRACE(v1::PictureStyle_Name(style) + (is_plain ? ", plain" : ""));
      v1::RenderRequest wanted = request(style);
      wanted.set_plain(is_plain);
      const Image image = drawn(*square, wanted);
      ASSERT_EQ(image.width, kSide);
      for (const int x : {60, 90, 110, 140}) {
        const std::uint8_t* const seen = pixel(image, x, kSide / 2);
        EXPECT_EQ(seen[0] > 2 * seen[2], !is_plain && x < kSide / 2) << x;
        EXPECT_EQ(seen[2] > 2 * seen[0], !is_plain && x > kSide / 2) << x;
      }
    }
  }
}

TEST(RenderPicture, AsksForItsMemory) {
  const auto ball = make_session(2000);
  for (const v1::PictureStyle style : {v1::PICTURE_STYLE_SURFACE, v1::PICTURE_STYLE_MESH}) {
    const v1::RenderRequest request = request_of(style, Vec3d(0, 0, 4), Vec3d::Zero(), 1000);
    curvecast::testing::CountingSource memory;
    drawn(*ball, request, {.memory = &memory});
    EXPECT_GE(memory.peak(), 40u * kSide * kSide);
    EXPECT_EQ(memory.taken(), 0u);
    curvecast::testing::CountingSource little(1'000'000);
    ViewCache cache;
    const absl::Status refused = render_picture(*ball, request, cache, {.memory = &little}).status();
    EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
    EXPECT_THAT(refused.message(), HasSubstr("a picture of 200 x 200 pixels takes"));
  }
}

TEST(RenderPicture, EndsWhenItIsCancelled) {
  const auto ball = make_session(2000);
  const std::atomic<bool> cancel = true;
  ViewCache cache;
  const v1::RenderRequest request = request_of(v1::PICTURE_STYLE_MESH, Vec3d(0, 0, 4), Vec3d::Zero(), 1);
  EXPECT_TRUE(absl::IsCancelled(render_picture(*ball, request, cache, {.cancel = &cancel}).status()));
}

}  // namespace
}  // namespace curvecast::server
