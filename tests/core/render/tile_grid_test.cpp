#include "core/render/tile_grid.h"

#include <gtest/gtest.h>

namespace curvecast {
namespace {

TEST(TileGrid, TilesAreInsideAndApart) {
  for (const int count : {1, 2, 3, 7, 50}) {
    const TileGrid grid = lay_out_tiles(400, 230, count, 20);
    ASSERT_GT(grid.side, 0);
    for (int i = 0; i < count; ++i) {
      EXPECT_GE(grid.x(i), grid.gap);
      EXPECT_GE(grid.y(i), grid.gap);
      EXPECT_LE(grid.x(i) + grid.side, 400 - grid.gap);
      EXPECT_LE(grid.y(i) + grid.side, grid.bottom());
      for (int k = 0; k < i; ++k) {
        EXPECT_TRUE(std::abs(grid.x(i) - grid.x(k)) >= grid.side + grid.gap ||
                    std::abs(grid.y(i) - grid.y(k)) >= grid.side + grid.gap);
      }
    }
    EXPECT_LE(grid.bottom(), 230 - grid.gap - 20);
  }
}

TEST(TileGrid, TwoLieSideBySideOnAWidePicture) {
  const TileGrid grid = lay_out_tiles(400, 200, 2, 0);
  EXPECT_EQ(grid.columns, 2);
  EXPECT_EQ(grid.y(0), grid.y(1));
  EXPECT_EQ(grid.place(1, {0, 0}), Vec2d(grid.x(1), grid.y(1) + grid.side));  // v points up
  EXPECT_EQ(grid.place(1, {1, 1}), Vec2d(grid.x(1) + grid.side, grid.y(1)));
}

TEST(TileGrid, TooManyHaveNoSide) { EXPECT_EQ(lay_out_tiles(64, 64, 5000, 0).side, 0); }

TEST(TileGrid, FramesLieOnTheSides) {
  Image image = blank_image(100, 100, {250, 240, 230});
  EXPECT_EQ(image.rgba[1], 240);
  EXPECT_EQ(image.rgba[3], 255);
  const TileGrid grid = lay_out_tiles(100, 100, 1, 0);
  draw_tile_frame(image, grid, 0);
  const auto red = [&](int x, int y) { return image.rgba[4 * (static_cast<std::size_t>(y) * 100 + x)]; };
  EXPECT_LT(red(grid.x(0), 50), 200);
  EXPECT_LT(red(50, grid.y(0)), 200);
  EXPECT_EQ(red(50, 50), 250);
}

}  // namespace
}  // namespace curvecast
