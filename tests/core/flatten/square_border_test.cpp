#include "core/flatten/square_border.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace curvecast
