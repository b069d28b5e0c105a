#include "core/flatten/square_border.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/flatten/cut_to_disc.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

TEST(SquareBorder, LengthsAlongASideAreInProportion) {
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::disc(6, 40)));
  const std::vector<Vec2d> uv = square_border(disc);
  const std::size_t n = disc.border.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2d &a = uv[disc.border[i]], &b = uv[disc.border[(i + 1) % n]], &c = uv[disc.border[(i + 2) % n]];
    if ((b.x() == 0 || b.x() == 1) && (b.y() == 0 || b.y() == 1)) continue;  // around a corner
    EXPECT_NEAR((b - a).norm(), (c - b).norm(), 1e-9);                       // the disc's rim has equal sides
  }
}

TEST(SquareBorder, FourVerticesAreTheCorners) {
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::single_triangle()));
  const std::vector<Vec2d> uv = square_border(disc);
  int corners = 0;
  for (const std::uint32_t v : disc.border) corners += (uv[v].x() == 0 || uv[v].x() == 1) && (uv[v].y() == 0 || uv[v].y() == 1);
  EXPECT_EQ(corners, 4);
}

/// The square's corners lie on the corners of a flat square whose border starts somewhere else on it.
bool finds_corners(std::ptrdiff_t start, double play) {
  DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::square(40)));
  const auto is_corner = [](double x, double y) { return (x == 0 || x == 1) && (y == 0 || y == 1); };
  std::vector<std::uint32_t>& border = disc.border;
  const auto first = std::find_if(border.begin(), border.end(),
                                  [&](std::uint32_t v) { return is_corner(disc.positions[v].x(), disc.positions[v].y()); });
  std::rotate(border.begin(), first, border.end());
  const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(border.size());
  std::rotate(border.begin(), border.begin() + (start + n) % n, border.end());
  const std::vector<Vec2d> uv = square_border(disc, play);
  return std::all_of(border.begin(), border.end(), [&](std::uint32_t v) {
    return is_corner(uv[v].x(), uv[v].y()) == is_corner(disc.positions[v].x(), disc.positions[v].y());
  });
}

TEST(SquareBorder, CornersGoWhereTheBorderTurns) {
  for (const std::ptrdiff_t start : {-12, -5, 0, 5, 12}) {  // of 160 edges
    EXPECT_TRUE(finds_corners(start, 0.1)) << start;
    EXPECT_EQ(finds_corners(start, 0), start == 0) << start;
  }
}

TEST(SquareBorder, CornersStayWhereNothingTurns) {
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::disc(6, 40)));
  EXPECT_EQ(square_border(disc, 0.1), square_border(disc));
}

}  // namespace
}  // namespace curvecast
