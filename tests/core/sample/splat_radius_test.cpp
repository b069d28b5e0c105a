#include "core/sample/splat_radius.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using testing::flat_curve;

TEST(SplatRadius, ShrinksWithTheRootOfTheDensityBelowTheBoxDiagonal) {
  const auto curve = flat_curve(2);
  const float diagonal = SplatRadius::largest(*curve);
  EXPECT_FLOAT_EQ(diagonal, std::sqrt(2.0f));
  const SplatRadius radius(*curve, 1e-4);
  EXPECT_EQ(radius(0), diagonal) << "a point where there is no density";
  for (float density = 1e-6f; density < 1e6f; density *= 3) {
    EXPECT_LE(radius(density), diagonal);
    if (radius(density) < diagonal) {
      EXPECT_NEAR(radius(4 * density) / radius(density), 0.5f, 1e-5f);
    }
  }
}

TEST(SplatRadius, DiscsOfThePointsCoverMoreThanTheSurface) {
  const auto curve = flat_curve(2);
  for (const double n : {10.0, 1e3, 1e6}) {
    const double radius = static_cast<double>(SplatRadius(*curve, 1 / n)(1));
    EXPECT_GT(n * 3.14159 * radius * radius, 3) << "the area of all discs, over that of the surface";
  }
}

TEST(SplatRadius, TheRungIsTheNextLargerRadius) {
  const auto curve = flat_curve(2);
  const RadiusLadder ladder(static_cast<double>(SplatRadius::largest(*curve)));
  const SplatRadius radius(*curve, 1e-3);
  for (float density = 1e-5f; density < 1e6f; density *= 1.7f) {
    const std::uint8_t rung = radius.rung(density);
    EXPECT_GE(ladder.radius(rung), radius(density) * 0.99999f);
    EXPECT_LT(ladder.radius(rung), radius(density) * 1.42f) << "half an octave";
  }
}

}  // namespace
}  // namespace curvecast
