#include "core/flatten/orientation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace curvecast {
namespace {

TEST(Orientation, TellsTheSign) {
  EXPECT_EQ(orientation({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orientation({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {3, 3}), 0);
}

TEST(Orientation, IsExactWhereDoublesRound) {
  // Kettner et al.: around a point on a line, plain arithmetic gives a random sign.
  const Vec2d q(12, 12), r(24, 24);
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vec2d p(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53);
      EXPECT_EQ(orientation(p, q, r), (i < j) ? 1 : (i > j ? -1 : 0)) << i << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace curvecast
