#include "core/render/uv_renderer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace curvecast {
namespace {

/// The square in two triangles, the left upper one with `ratio` times the surface per area of the right lower one.
struct Halves {
  std::vector<Vec2d> uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  std::vector<double> ratios;

  explicit Halves(double ratio, double scale = 1) : ratios{scale, scale * ratio} {}
  UvDisc disc() const { return {uv, triangles, ratios}; }
};

std::array<int, 3> pixel(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
  return {p[0], p[1], p[2]};
}

bool is_red(const std::array<int, 3>& c) { return c[0] > c[2] + 20; }
bool is_blue(const std::array<int, 3>& c) { return c[2] > c[0] + 20; }

TEST(UvRenderer, ColoursBySurfaceOverParameterArea) {
  const Halves halves(4);
  const auto picture = render_uv(std::vector<UvDisc>{halves.disc()}, {.width = 200, .height = 220});
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->image.width, 200);
  EXPECT_EQ(picture->image.rgba.size(), 4u * 200 * 220);
  EXPECT_EQ(picture->tiles, 1);
  EXPECT_NEAR(picture->scale, 3, 1e-9);  // ratios to the mean are 0.4 and 1.6
  EXPECT_TRUE(is_red(pixel(picture->image, 60, 60)));
  EXPECT_TRUE(is_blue(pixel(picture->image, 140, 140)));
}

TEST(UvRenderer, AnEvenMapIsPale) {
  const Halves halves(1, 7);
  const auto picture = render_uv(std::vector<UvDisc>{halves.disc()}, {.width = 128, .height = 128});
  ASSERT_TRUE(picture.ok());
  EXPECT_NEAR(picture->scale, 2, 1e-9);
  for (const int c : pixel(picture->image, 40, 60)) EXPECT_NEAR(c, 247, 2);
}

TEST(UvRenderer, TheLargestDiscComesFirstAndTheRestIsLeftOut) {
  const Halves small(1), large(9, 100);
  const std::vector<UvDisc> discs = {small.disc(), large.disc(), small.disc()};
  const auto all = render_uv(discs, {.width = 400, .height = 200});
  ASSERT_TRUE(all.ok());
  EXPECT_EQ(all->tiles, 3);
  EXPECT_TRUE(is_red(pixel(all->image, 50, 80)));  // the first square from the left
  EXPECT_FALSE(is_red(pixel(all->image, 180, 80)));
  const auto one = render_uv(discs, {.width = 200, .height = 200, .max_tiles = 1});
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(one->tiles, 1);
}

TEST(UvRenderer, RefusesWhatItCannotDraw) {
  const Halves halves(1);
  const std::vector<UvDisc> good = {halves.disc()};
  EXPECT_FALSE(render_uv({}).ok());
  EXPECT_FALSE(render_uv(good, {.width = 8, .height = 100}).ok());
  EXPECT_FALSE(render_uv(good, {.supersample = 9}).ok());
  EXPECT_FALSE(render_uv(std::vector<UvDisc>(5000, halves.disc()), {.width = 64, .height = 64, .max_tiles = 5000}).ok());
  Halves outside(1);
  outside.uv[2] = {1.5, 1};
  EXPECT_FALSE(render_uv(std::vector<UvDisc>{outside.disc()}).ok());
  outside.uv[2] = {std::nan(""), 1};
  EXPECT_FALSE(render_uv(std::vector<UvDisc>{outside.disc()}).ok());
  Halves index(1);
  index.triangles[0][1] = 9;
  EXPECT_FALSE(render_uv(std::vector<UvDisc>{index.disc()}).ok());
  Halves shorter(1);
  shorter.ratios.pop_back();
  EXPECT_FALSE(render_uv(std::vector<UvDisc>{shorter.disc()}).ok());
}

}  // namespace
}  // namespace curvecast
