#include "core/render/curve_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/curve/hilbert.h"
#include "core/render/tile_grid.h"

namespace curvecast {
namespace {

/// The Hilbert curve of a level.
struct Path {
  std::vector<Vec2d> points;
  std::vector<double> sides;

  explicit Path(int level) {
    const double side = std::ldexp(1.0, -level);
    for (std::uint64_t i = 0; i < std::uint64_t{1} << (2 * level); ++i) {
      const HilbertCell cell = hilbert_cell(i, level);
      points.emplace_back((cell.x + 0.5) * side, (cell.y + 0.5) * side);
      sides.push_back(side);
    }
  }
  CurvePath path() const { return {points, sides, {}, {}}; }
};

Rgb8 pixel(const Image& image, const Vec2d& at) {
  const auto i = 4 * (static_cast<std::size_t>(at.y()) * image.width + static_cast<std::size_t>(at.x()));
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

int distance(const Rgb8& a, const Rgb8& b) {
  int largest = 0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

/// As the eye sees it, 0 to 255 (Rec. 709, gamma and all).
double luma(const Rgb8& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

constexpr Rgb8 kWhite = {255, 255, 255};

TEST(CurveColour, GetsLighterAllTheWayWithoutJumps) {
  for (int i = 0; i < 1000; ++i) {
    const Rgb8 before = curve_colour(i / 1000.0), after = curve_colour((i + 1) / 1000.0);
    EXPECT_LE(distance(before, after), 2);
    EXPECT_GE(luma(after), luma(before) - 1);
  }
  EXPECT_LT(luma(curve_colour(1)), 180);  // seen on white
  EXPECT_EQ(curve_colour(-3), curve_colour(0));
  EXPECT_EQ(curve_colour(std::numeric_limits<double>::infinity()), curve_colour(1));
}

TEST(CurveRenderer, TheLinePassesThroughItsPointsInTheColoursOfItsLength) {
  const Path hilbert(3);
  const std::vector<CurvePath> paths = {hilbert.path()};
  const auto image = render_curves(paths, {.width = 300, .height = 300, .line_width = 3});
  ASSERT_TRUE(image.ok()) << image.status();
  const TileGrid grid = lay_out_tiles(300, 300, 1, 0);
  for (std::size_t i = 0; i < hilbert.points.size(); ++i) {
    const Rgb8 colour = curve_colour(static_cast<double>(i) / static_cast<double>(hilbert.points.size() - 1));
    EXPECT_LT(distance(pixel(*image, grid.place(0, hilbert.points[i])), colour), 16) << i;
  }
  // Nothing joins what the curve does not join: the lower halves of the first and last quadrant.
  EXPECT_EQ(pixel(*image, grid.place(0, {0.5, 0.0625})), kWhite);
  EXPECT_EQ(pixel(*image, grid.place(0, {0.5, 0.25})), kWhite);
}

TEST(CurveRenderer, DenseCurvesLeaveSpaceBetweenTheirLines) {
  const Path hilbert(6);
  const std::vector<CurvePath> paths = {hilbert.path()};
  const auto image = render_curves(paths, {.width = 512, .height = 512, .line_width = 64});
  ASSERT_TRUE(image.ok());
  int white = 0, all = 0;
  for (std::size_t i = 0; i < image->rgba.size(); i += 4, ++all) white += image->rgba[i + 1] > 200;
  EXPECT_GT(white, all / 5);
  EXPECT_LT(white, all * 4 / 5);
}

TEST(CurveRenderer, DiscsLieSideBySideInTheirOrder) {
  const Path coarse(1), fine(5);
  const std::vector<CurvePath> paths = {coarse.path(), fine.path()};
  const auto image = render_curves(paths, {.width = 400, .height = 200, .line_width = 2});
  ASSERT_TRUE(image.ok());
  const auto ink = [&](int from, int to) {
    int sum = 0;
    for (int y = 0; y < 200; ++y) {
      for (int x = from; x < to; ++x) sum += pixel(*image, Vec2d(x, y)) != kWhite;
    }
    return sum;
  };
  EXPECT_GT(ink(200, 400), 3 * ink(0, 200));
}

TEST(CurveRenderer, TheMeshIsFaintBehind) {
  const Path hilbert(1);
  const std::vector<Vec2d> uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<CurvePath> paths = {{hilbert.points, hilbert.sides, uv, triangles}};
  const auto image = render_curves(paths, {.width = 300, .height = 300, .line_width = 3});
  ASSERT_TRUE(image.ok());
  const Rgb8 diagonal = pixel(*image, lay_out_tiles(300, 300, 1, 0).place(0, {0.4, 0.4}));
  EXPECT_NE(diagonal, kWhite);
  EXPECT_LT(distance(diagonal, kWhite), 60);
}

TEST(CurveRenderer, RefusesWhatItCannotDraw) {
  const Path hilbert(1);
  const std::vector<CurvePath> good = {hilbert.path()};
  EXPECT_FALSE(render_curves({}).ok());
  EXPECT_FALSE(render_curves(good, {.width = 8, .height = 100}).ok());
  EXPECT_FALSE(render_curves(good, {.line_width = std::nan("")}).ok());
  EXPECT_FALSE(render_curves(good, {.line_width = -1}).ok());
  EXPECT_FALSE(render_curves(std::vector<CurvePath>(5000, hilbert.path()), {.width = 64, .height = 64}).ok());
  Path outside(1);
  outside.points[0] = {1.5, 0};
  EXPECT_FALSE(render_curves(std::vector<CurvePath>{outside.path()}).ok());
  outside.points[0] = {std::nan(""), 0};
  EXPECT_FALSE(render_curves(std::vector<CurvePath>{outside.path()}).ok());
  Path shorter(1);
  shorter.sides.pop_back();
  EXPECT_FALSE(render_curves(std::vector<CurvePath>{shorter.path()}).ok());
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  EXPECT_FALSE(render_curves(std::vector<CurvePath>{{hilbert.points, hilbert.sides, {}, triangles}}).ok());
}

}  // namespace
}  // namespace curvecast
